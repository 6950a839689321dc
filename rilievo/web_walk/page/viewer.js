// Generated from web/src by web/tools/build.js: do not edit.
"use strict";var rilievo=(()=>{var ae=Object.defineProperty;var ze=Object.getOwnPropertyDescriptor;var qe=Object.getOwnPropertyNames;var Me=Object.prototype.hasOwnProperty;var Ke=(s,e)=>{for(var a in e)ae(s,a,{get:e[a],enumerable:!0})},We=(s,e,a,t)=>{if(e&&typeof e=="object"||typeof e=="function")for(let i of qe(e))!Me.call(s,i)&&i!==a&&ae(s,i,{get:()=>e[i],enumerable:!(t=ze(e,i))||t.enumerable});return s};var Ne=s=>We(ae({},"__esModule",{value:!0}),s);var wa={};Ke(wa,{Walk:()=>N,WalkError:()=>_,show:()=>ga});var M=[[1,0,0,0,0,-1,0,-1,0],[-1,0,0,0,0,1,0,-1,0],[0,1,0,1,0,0,0,0,1],[0,-1,0,1,0,0,0,0,-1],[0,0,1,1,0,0,0,-1,0],[0,0,-1,-1,0,0,0,-1,0]],J=class{constructor(e,a,t){this.nodes=e;this.codes=a;this.sketches=t;this.table=new Float32Array(65536);this.best=new Uint32Array(e.length),this.keys=new Float64Array(e.length);let{near:i,far:r}=t;for(let o=1;o<65535;++o)this.table[o]=i*Math.pow(r/i,(o-1)/65533);this.table[65535]=1/0}sees(e,a,t,i){let r=this.nodes[e].worldFromNode,o=a-r[12],n=t-r[13],c=i-r[14],b=Math.sqrt(o*o+n*n+c*c);if(b===0)return!0;let h=r[0]*o+r[1]*n+r[2]*c,l=r[4]*o+r[5]*n+r[6]*c,p=r[8]*o+r[9]*n+r[10]*c,d=0,m=0;for(let E=0;E<6;++E){let j=M[E],L=h*j[0]+l*j[1]+p*j[2];L>m&&(m=L,d=E)}let v=M[d],g=this.sketches.size,w=this.place((h*v[3]+l*v[4]+p*v[5])/m),A=this.place(-(h*v[6]+l*v[7]+p*v[8])/m);return b<=this.table[this.codes[((e*6+d)*g+A)*g+w]]}order(e,a,t){let{best:i,keys:r,nodes:o}=this;for(let n=0;n<o.length;++n){let c=o[n].eye,b=c[0]-e,h=c[1]-a,l=c[2]-t,p=Math.sqrt(b*b+h*h+l*l),d=this.sees(n,e,a,t)?p:1e30+p*1e15,m=n;for(;m>0&&r[m-1]>d;--m)r[m]=r[m-1],i[m]=i[m-1];r[m]=d,i[m]=n}}place(e){let a=this.sketches.size;return Math.min(a-1,Math.max(0,Math.trunc(.5*(1+e)*a)))}};var le='"use strict";(()=>{var R=class extends Error{constructor(d,g){super(`${d}: ${g}`);this.where=d;this.reason=g;this.name="WalkError"}};function L(a,e){return a instanceof R?a:new R(e,a instanceof Error?a.message:String(a))}var J=(function(){var a="b9H79Tebbbe8Fv9Gbb9Gvuuuuueu9Giuuub9Geueu9Giuuueuixkbeeeddddillviebeoweuecj:Gdkr;Neqo9TW9T9VV95dbH9F9F939H79T9F9J9H229F9Jt9VV7bb8A9TW79O9V9Wt9F9KW9J9V9KW9wWVtW949c919M9MWVbeY9TW79O9V9Wt9F9KW9J9V9KW69U9KW949c919M9MWVbdE9TW79O9V9Wt9F9KW9J9V9KW69U9KW949tWG91W9U9JWbiL9TW79O9V9Wt9F9KW9J9V9KWS9P2tWV9p9JtblK9TW79O9V9Wt9F9KW9J9V9KWS9P2tWV9r919HtbvL9TW79O9V9Wt9F9KW9J9V9KWS9P2tWVT949WboY9TW79O9V9Wt9F9KW9J9V9KWS9P2tWVJ9V29VVbrl79IV9Rbwq;X8:kdbk:kYi5ud9:du8Jjjjjbcjq9Rgv8Kjjjjbc9:hodnalTmbcuhoaiRbbgrc;WeGc:Ge9hmbarcsGgwce0mbc9:hoalcufadcd4cbawEgDadfgrcKcaawEgqaraq0Egk6mbaicefhxcj;abad9Uc;WFbGcjdadca0EhmaialfgPar9Rgoadfhsavaoadz:jjjjbgzceVhHcbhOdndninaeaO9nmeaPax9RaD6mdamaeaO9RaOamfgoae6EgAcsfglc9WGhCaAcethXaxaDfhiaOaeaoaeao6E9RhQalcl4cifcd4hLazcjdfaAfhKcbhYabaOad2fg8AhEaHh3incbh5dnawTmbaxaYcd4fRbbh5kcbh8Eazcjdfhqinaih8Fdndndndna5a8Ecet4ciGgoc9:fPdebdkaPa8F9RaA6mrazcjdfa8EaA2fa8FaAz:jjjjb8Aa8FaAfhixdkazcjdfa8EaA2fcbaAz:kjjjb8Aa8FhixekaPa8F9RaL6mva8FaLfhidnaCTmbaPai9RcK6mbaocdtc:q:G:cjbfcj:G:cjbawEhaczhrcbhlinargoc9Wfghaqfhrdndndndndndnaaa8Fahco4fRbbalcoG4ciGcdtfydbPDbedvivvvlvkar9cb83bwar9cb83bbxlkarcbaiRbdai8Xbb9c:c:qj:bw9:9c:q;c1:I1e:d9c:b:c:e1z9:gg9cjjjjjz:dg8J9qE86bbaqaofgrcGfcbaicdfa8J9c8N1:NfghRbbag9cjjjjjw:dg8J9qE86bbarcVfcbaha8J9c8M1:NfghRbbag9cjjjjjl:dg8J9qE86bbarc7fcbaha8J9c8L1:NfghRbbag9cjjjjjd:dg8J9qE86bbarctfcbaha8J9c8K1:NfghRbbag9cjjjjje:dg8J9qE86bbarc91fcbaha8J9c8J1:NfghRbbag9cjjjj;ab:dg8J9qE86bbarc4fcbaha8J9cg1:NfghRbbag9cjjjja:dg8J9qE86bbarc93fcbaha8J9ch1:NfghRbbag9cjjjjz:dgg9qE86bbarc94fcbahag9ca1:NfghRbbai8Xbe9c:c:qj:bw9:9c:q;c1:I1e:d9c:b:c:e1z9:gg9cjjjjjz:dg8J9qE86bbarc95fcbaha8J9c8N1:NfgiRbbag9cjjjjjw:dg8J9qE86bbarc96fcbaia8J9c8M1:NfgiRbbag9cjjjjjl:dg8J9qE86bbarc97fcbaia8J9c8L1:NfgiRbbag9cjjjjjd:dg8J9qE86bbarc98fcbaia8J9c8K1:NfgiRbbag9cjjjjje:dg8J9qE86bbarc99fcbaia8J9c8J1:NfgiRbbag9cjjjj;ab:dg8J9qE86bbarc9:fcbaia8J9cg1:NfgiRbbag9cjjjja:dg8J9qE86bbarcufcbaia8J9ch1:NfgiRbbag9cjjjjz:dgg9qE86bbaiag9ca1:NfhixikaraiRblaiRbbghco4g8Ka8KciSg8KE86bbaqaofgrcGfaiclfa8Kfg8KRbbahcl4ciGg8La8LciSg8LE86bbarcVfa8Ka8Lfg8KRbbahcd4ciGg8La8LciSg8LE86bbarc7fa8Ka8Lfg8KRbbahciGghahciSghE86bbarctfa8Kahfg8KRbbaiRbeghco4g8La8LciSg8LE86bbarc91fa8Ka8Lfg8KRbbahcl4ciGg8La8LciSg8LE86bbarc4fa8Ka8Lfg8KRbbahcd4ciGg8La8LciSg8LE86bbarc93fa8Ka8Lfg8KRbbahciGghahciSghE86bbarc94fa8Kahfg8KRbbaiRbdghco4g8La8LciSg8LE86bbarc95fa8Ka8Lfg8KRbbahcl4ciGg8La8LciSg8LE86bbarc96fa8Ka8Lfg8KRbbahcd4ciGg8La8LciSg8LE86bbarc97fa8Ka8Lfg8KRbbahciGghahciSghE86bbarc98fa8KahfghRbbaiRbigico4g8Ka8KciSg8KE86bbarc99faha8KfghRbbaicl4ciGg8Ka8KciSg8KE86bbarc9:faha8KfghRbbaicd4ciGg8Ka8KciSg8KE86bbarcufaha8KfgrRbbaiciGgiaiciSgiE86bbaraifhixdkaraiRbwaiRbbghcl4g8Ka8KcsSg8KE86bbaqaofgrcGfaicwfa8Kfg8KRbbahcsGghahcsSghE86bbarcVfa8KahfghRbbaiRbeg8Kcl4g8La8LcsSg8LE86bbarc7faha8LfghRbba8KcsGg8Ka8KcsSg8KE86bbarctfaha8KfghRbbaiRbdg8Kcl4g8La8LcsSg8LE86bbarc91faha8LfghRbba8KcsGg8Ka8KcsSg8KE86bbarc4faha8KfghRbbaiRbig8Kcl4g8La8LcsSg8LE86bbarc93faha8LfghRbba8KcsGg8Ka8KcsSg8KE86bbarc94faha8KfghRbbaiRblg8Kcl4g8La8LcsSg8LE86bbarc95faha8LfghRbba8KcsGg8Ka8KcsSg8KE86bbarc96faha8KfghRbbaiRbvg8Kcl4g8La8LcsSg8LE86bbarc97faha8LfghRbba8KcsGg8Ka8KcsSg8KE86bbarc98faha8KfghRbbaiRbog8Kcl4g8La8LcsSg8LE86bbarc99faha8LfghRbba8KcsGg8Ka8KcsSg8KE86bbarc9:faha8KfghRbbaiRbrgicl4g8Ka8KcsSg8KE86bbarcufaha8KfgrRbbaicsGgiaicsSgiE86bbaraifhixekarai8Pbw83bwarai8Pbb83bbaiczfhikdnaoaC9pmbalcdfhlaoczfhraPai9RcL0mekkaoaC6moaimexokaCmva8FTmvkaqaAfhqa8Ecefg8Ecl9hmbkdndndndnawTmbasaYcd4fRbbgociGPlbedrbkaATmdazaYfh8Fazcjdfhhcbh8EaEhaina8FRbbhraahocbhlinaoahalfRbbgqce4cbaqceG9R7arfgr86bbaoadfhoaAalcefgl9hmbkaacefhaa8Fcefh8FahaAfhha8Ecefg8Ecl9hmbxikkaATmeazaYfhaazcjdfhhcbhoceh8EaKh8FinaEaofhlaa8Vbbhrcbhoinala8FaofRbbcwtahaofRbbgqVc;:FiGce4cbaqceG9R7arfgr87bbaladfhlaQaocefgofmbka8FaXfh8FcdhoaacdfhaahaXfhha8EceGhlcbh8EalmbxdkkaATmbaocl4h8EazaYfRbbhqcwhoa3hlinalRbbaotaqVhqalcefhlaocwfgoca9hmbkcbhhaEh8FaKhainazcjdfahfRbbhrcwhoaahlinalRbbaotarVhralaAfhlaocwfgoca9hmbkara8E94aq7hqcbhoa8Fhlinalaqao486bbalcefhlaocwfgoca9hmbka8Fadfh8FaacefhaahcefghaA9hmbkkaEclfhEa3clfh3aYclfgYad6mbkaza8AaAcufad2fadz:jjjjb8AaAaOfhOaihxaimbkc9:hoxdkcbc99aPax9RakSEhoxekc9:hokavcjqf8Kjjjjbaok:bsesu8Jjjjjbc;ae9Rgv8Kjjjjbc9:hodnalaeci9UgrcHf6mbcuhoaiRbbgwc;WeGc;Ge9hmbawcsGgwce0mbavc;abfcFecjez:kjjjb8Aav9cu83iUav9cu83i8Wav9cu83iyav9cu83iaav9cu83iKav9cu83izav9cu83iwav9cu83ibaialfc9WfhDaicefgiarfhqdndnaeci9pmbaqhexekcmcsawceSEhkcbhxcbhmaqhecbhlcbhoindndnaiRbbgrc;Ve0mbavc;abfaoarcu7gPcl4fcsGcitfgwydlhsawydbhzdndnarcsGgwak9pmbavalaPfcsGcdtfydbaxawEhraxawTgHfhxxekdnaeaD9nmbc9:hoxokdndnawcsSmbcehHamawcetfcWfhrxekaecefhrae8SbbgwcFeGhPdndnawcu9mmbarhexekaecvfheaPcFbGhPcrhwdninar8SbbgHcFbGawtaPVhPaHcu9kmearcefhrawcrfgwc8J9hmbxdkkarcefhekcehHaPce4cbaPceG9R7amfhrkarhmkavc;abfaocitfgwarBdbawasBdlavalcdtfarBdbavc;abfaocefcsGcitfgwazBdbawarBdlaocdfhoaHalfhldnadcd9hmbabar87elabas87edabaz87ebabcofhbxdkabarBdwabasBdlabazBdbabcxfhbxekdnarcpe0mbavalaDarcsGfRbbgwcl4gP9RcsGcdtfydbaxcefgsaPEhravalaw9RcsGcdtfydbasaPTgzfgsawcsGgPEhwaPThPdndnadcd9hmbabaw87elabar87edabax87ebcohHxekabawBdwabarBdlabaxBdbcxhHkavalcdtfaxBdbavc;abfaocitfgOarBdbaOaxBdlavalcefglcsGcdtfarBdbavc;abfaocefcsGcitfgOawBdbaOarBdlavalazfglcsGcdtfawBdbavc;abfaocdfcsGcitfgraxBdbarawBdlaocifhoabaHfhbalaPfhlasaPfhxxekdnaeaD9nmbc9:hoxlkaxcbaeRbbgwEgHarc;:eSgrfhsawcsGhOdndnawcl4gAmbascefhzxekashzavalaA9RcsGcdtfydbhskdndnaOmbazcefhxxekazhxavalaw9RcsGcdtfydbhzkdndnarTmbaecefhrxekaecdfhrae8SbegPcFeGhwdnaPcu9kmbaecofhHawcFbGhwcrhedninar8SbbgPcFbGaetawVhwaPcu9kmearcefhraecrfgec8J9hmbkaHhrxekarcefhrkawce4cbawceG9R7amfgmhHkdndnaAcsSmbarhwxekarcefhwar8SbbgecFeGhPdnaecu9kmbarcvfhsaPcFbGhPcrhedninaw8SbbgrcFbGaetaPVhParcu9kmeawcefhwaecrfgec8J9hmbkashwxekawcefhwkaPce4cbaPceG9R7amfgmhskdndnaOcsSmbawhexekawcefheaw8SbbgrcFeGhPdnarcu9kmbawcvfhzaPcFbGhPcrhrdninae8SbbgwcFbGartaPVhPawcu9kmeaecefhearcrfgrc8J9hmbkazhexekaecefhekaPce4cbaPceG9R7amfgmhzkdndnadcd9hmbabaz87elabas87edabaH87ebcohrxekabazBdwabasBdlabaHBdbcxhrkavc;abfaocitfgwasBdbawaHBdlavalcdtfaHBdbavc;abfaocefcsGcitfgwazBdbawasBdlavalcefglcsGcdtfasBdbavc;abfaocdfcsGcitfgwaHBdbawazBdlavalaATaAcsSVfglcsGcdtfazBdbalaOTaOcsSVfhlaocifhoabarfhbkaocsGhoalcsGhlaicefgiaq6mbkkcbc99aeaDSEhokavc;aef8Kjjjjbaok:clevu8Jjjjjbcz9Rhvdnalaecvf9pmbc9:skdnaiRbbc;:eGc;qeSmbcuskav9cb83iwaicefhoaialfc98fhrdnaeTmbdnadcdSmbcbhwindnaoar6mbc9:skaocefhlao8SbbgicFeGhddndnaicu9mmbalhoxekaocvfhoadcFbGhdcrhidninal8SbbgDcFbGaitadVhdaDcu9kmealcefhlaicrfgic8J9hmbxdkkalcefhokabawcdtfadc8Etc8F91adcd47avcwfadceGcdtVglydbfgiBdbalaiBdbawcefgwae9hmbxdkkcbhwindnaoar6mbc9:skaocefhlao8SbbgicFeGhddndnaicu9mmbalhoxekaocvfhoadcFbGhdcrhidninal8SbbgDcFbGaitadVhdaDcu9kmealcefhlaicrfgic8J9hmbxdkkalcefhokabawcetfadc8Etc8F91adcd47avcwfadceGcdtVglydbfgi87ebalaiBdbawcefgwae9hmbkkcbc99aoarSEk:Lvoeue99dud99eud99dndnadcl9hmbaeTmeindndnabcdfgd8Sbb:Yab8Sbbgi:Ygl:l:tabcefgv8Sbbgo:Ygr:l:tgwJbb;:9cawawNJbbbbawawJbbbb9GgDEgq:mgkaqaicb9iEalMgwawNakaqaocb9iEarMgqaqNMM:r:vglNJbbbZJbbb:;aDEMgr:lJbbb9p9DTmbar:Ohixekcjjjj94hikadai86bbdndnaqalNJbbbZJbbb:;aqJbbbb9GEMgq:lJbbb9p9DTmbaq:Ohdxekcjjjj94hdkavad86bbdndnawalNJbbbZJbbb:;awJbbbb9GEMgw:lJbbb9p9DTmbaw:Ohdxekcjjjj94hdkabad86bbabclfhbaecufgembxdkkaeTmbindndnabclfgd8Ueb:Yab8Uebgi:Ygl:l:tabcdfgv8Uebgo:Ygr:l:tgwJb;:FSawawNJbbbbawawJbbbb9GgDEgq:mgkaqaicb9iEalMgwawNakaqaocb9iEarMgqaqNMM:r:vglNJbbbZJbbb:;aDEMgr:lJbbb9p9DTmbar:Ohixekcjjjj94hikadai87ebdndnaqalNJbbbZJbbb:;aqJbbbb9GEMgq:lJbbb9p9DTmbaq:Ohdxekcjjjj94hdkavad87ebdndnawalNJbbbZJbbb:;awJbbbb9GEMgw:lJbbb9p9DTmbaw:Ohdxekcjjjj94hdkabad87ebabcwfhbaecufgembkkk:4ioiue99dud99dud99dnaeTmbcbhiabhlindndnal8Uebgv:YgoJ:ji:1Salcof8UebgrciVgw:Y:vgDNJbbbZJbbb:;avcu9kEMgq:lJbbb9p9DTmbaq:Ohkxekcjjjj94hkkalclf8Uebhvalcdf8UebhxalarcefciGcetfak87ebdndnax:YgqaDNJbbbZJbbb:;axcu9kEMgm:lJbbb9p9DTmbam:Ohxxekcjjjj94hxkabaiarciGgkfcd7cetfax87ebdndnav:YgmaDNJbbbZJbbb:;avcu9kEMgP:lJbbb9p9DTmbaP:Ohvxekcjjjj94hvkalarcufciGcetfav87ebdndnawaw2:ZgPaPMaoaoN:taqaqN:tamamN:tgoJbbbbaoJbbbb9GE:raDNJbbbZMgD:lJbbb9p9DTmbaD:Ohrxekcjjjj94hrkalakcetfar87ebalcwfhlaiclfhiaecufgembkkk9mbdnadcd4ae2gdTmbinababydbgecwtcw91:Yaece91cjjj98Gcjjj;8if::NUdbabclfhbadcufgdmbkkk:Tvirud99eudndnadcl9hmbaeTmeindndnabRbbgiabcefgl8Sbbgvabcdfgo8Sbbgrf9R:YJbbuJabcifgwRbbgdce4adVgDcd4aDVgDcl4aDVgD:Z:vgqNJbbbZMgk:lJbbb9p9DTmbak:Ohxxekcjjjj94hxkaoax86bbdndnaraif:YaqNJbbbZMgk:lJbbb9p9DTmbak:Ohoxekcjjjj94hokalao86bbdndnavaifar9R:YaqNJbbbZMgk:lJbbb9p9DTmbak:Ohixekcjjjj94hikabai86bbdndnaDadcetGadceGV:ZaqNJbbbZMgq:lJbbb9p9DTmbaq:Ohdxekcjjjj94hdkawad86bbabclfhbaecufgembxdkkaeTmbindndnab8Vebgiabcdfgl8Uebgvabclfgo8Uebgrf9R:YJbFu9habcofgw8Vebgdce4adVgDcd4aDVgDcl4aDVgDcw4aDVgD:Z:vgqNJbbbZMgk:lJbbb9p9DTmbak:Ohxxekcjjjj94hxkaoax87ebdndnaraif:YaqNJbbbZMgk:lJbbb9p9DTmbak:Ohoxekcjjjj94hokalao87ebdndnavaifar9R:YaqNJbbbZMgk:lJbbb9p9DTmbak:Ohixekcjjjj94hikabai87ebdndnaDadcetGadceGV:ZaqNJbbbZMgq:lJbbb9p9DTmbaq:Ohdxekcjjjj94hdkawad87ebabcwfhbaecufgembkkk9teiucbcbyd:K:G:cjbgeabcifc98GfgbBd:K:G:cjbdndnabZbcztgd9nmbcuhiabad9RcFFifcz4nbcuSmekaehikaik;LeeeudndnaeabVciGTmbabhixekdndnadcz9pmbabhixekabhiinaiaeydbBdbaiclfaeclfydbBdbaicwfaecwfydbBdbaicxfaecxfydbBdbaeczfheaiczfhiadc9Wfgdcs0mbkkadcl6mbinaiaeydbBdbaeclfheaiclfhiadc98fgdci0mbkkdnadTmbinaiaeRbb86bbaicefhiaecefheadcufgdmbkkabk;aeedudndnabciGTmbabhixekaecFeGc:b:c:ew2hldndnadcz9pmbabhixekabhiinaialBdbaicxfalBdbaicwfalBdbaiclfalBdbaiczfhiadc9Wfgdcs0mbkkadcl6mbinaialBdbaiclfhiadc98fgdci0mbkkdnadTmbinaiae86bbaicefhiadcufgdmbkkabkk83dbcj:Gdk8Kbbbbdbbblbbbwbbbbbbbebbbdbbblbbbwbbbbc:K:Gdkl8W:qbb",e="b9H79TebbbeKl9Gbb9Gvuuuuueu9Giuuub9Geueuixkbbebeeddddilve9Weeeviebeoweuecj:Gdkr;Neqo9TW9T9VV95dbH9F9F939H79T9F9J9H229F9Jt9VV7bb8A9TW79O9V9Wt9F9KW9J9V9KW9wWVtW949c919M9MWVbdY9TW79O9V9Wt9F9KW9J9V9KW69U9KW949c919M9MWVblE9TW79O9V9Wt9F9KW9J9V9KW69U9KW949tWG91W9U9JWbvL9TW79O9V9Wt9F9KW9J9V9KWS9P2tWV9p9JtboK9TW79O9V9Wt9F9KW9J9V9KWS9P2tWV9r919HtbrL9TW79O9V9Wt9F9KW9J9V9KWS9P2tWVT949WbwY9TW79O9V9Wt9F9KW9J9V9KWS9P2tWVJ9V29VVbDl79IV9Rbqq:I9Dklbzik94evu8Jjjjjbcz9Rhbcbheincbhdcbhiinabcwfadfaicjuaead4ceGglE86bbaialfhiadcefgdcw9hmbkaeai86b:q:W:cjbaecitab8Piw83i:q:G:cjbaecefgecjd9hmbkk:SBlEud97dur978Jjjjjbcj;kb9Rgv8Kjjjjbc9:hodnalTmbcuhoaiRbbgrc;WeGc:Ge9hmbarcsGgwce0mbc9:hoalcufadcd4cbawEgDadfgrcKcaawEgqaraq0Egk6mbaialfgxar9RhodnadTgmmbavaoad;8qbbkaicefhPcj;abad9Uc;WFbGcjdadca0EhsdndndnadTmbaoadfhzcbhHinaeaH9nmdaxaP9RaD6miabaHad2fgOavcjdfasaeaH9RaHasfae6EgAaAcsfgoc9WGgCSEhXaPaDfhQaocl4cifcd4hLavcj;cbfaCcetfhKavcj;cbfaCci2fhYavcj;cbfaCfh8AcbhEaoc;ab6h3incbh5dnawTmbaPaEcd4fRbbh5kcbh8Eavcj;cbfh8Findndndndna5a8Ecet4ciGgoc9:fPdebdkaxaQ9RaC6mwdnaCTmbavcj;cbfa8EaC2faQaC;8qbbkaQaAfhQxdkaCTmeavcj;cbfa8EaC2fcbaC;8kbxekaxaQ9RaL6moaoclVcbawEhraQaLfhocbhidna3mbaxao9Rc;Gb6mbcbhlina8FalfhidndndndndndnaQalco4fRbbgqciGarfPDbedibledibkaipxbbbbbbbbbbbbbbbbpklbxlkaiaopbblaopbbbgaclp:meaapmbzeHdOiAlCvXoQrLgacdp:meaapmbzeHdOiAlCvXoQrLpxiiiiiiiiiiiiiiiip9oghpxiiiiiiiiiiiiiiiip8Jgap5b9cjF;8;4;W;G;ab9:9cU1:Nggcitpbi:q:G:cjbagRb:q:W:cjbggpsaap5e9cjF;8;4;W;G;ab9:9cU1:Ng8Jcitpbi:q:G:cjbp9UpmbedilvorzHOACXQLpPahaap9spklbagaoclffa8JRb:q:W:cjbfhoxikaiaopbbwaopbbbgaclp:meaapmbzeHdOiAlCvXoQrLpxssssssssssssssssp9oghpxssssssssssssssssp8Jgap5b9cjF;8;4;W;G;ab9:9cU1:Nggcitpbi:q:G:cjbagRb:q:W:cjbggpsaap5e9cjF;8;4;W;G;ab9:9cU1:Ng8Jcitpbi:q:G:cjbp9UpmbedilvorzHOACXQLpPahaap9spklbagaocwffa8JRb:q:W:cjbfhoxdkaiaopbbbpklbaoczfhoxekaiaopbbdaoRbbggcitpbi:q:G:cjbagRb:q:W:cjbggpsaoRbeg8Jcitpbi:q:G:cjbp9UpmbedilvorzHOACXQLpPpklbagaocdffa8JRb:q:W:cjbfhokdndndndndndnaqcd4ciGarfPDbedibledibkaiczfpxbbbbbbbbbbbbbbbbpklbxlkaiczfaopbblaopbbbgaclp:meaapmbzeHdOiAlCvXoQrLgacdp:meaapmbzeHdOiAlCvXoQrLpxiiiiiiiiiiiiiiiip9oghpxiiiiiiiiiiiiiiiip8Jgap5b9cjF;8;4;W;G;ab9:9cU1:Nggcitpbi:q:G:cjbagRb:q:W:cjbggpsaap5e9cjF;8;4;W;G;ab9:9cU1:Ng8Jcitpbi:q:G:cjbp9UpmbedilvorzHOACXQLpPahaap9spklbagaoclffa8JRb:q:W:cjbfhoxikaiczfaopbbwaopbbbgaclp:meaapmbzeHdOiAlCvXoQrLpxssssssssssssssssp9oghpxssssssssssssssssp8Jgap5b9cjF;8;4;W;G;ab9:9cU1:Nggcitpbi:q:G:cjbagRb:q:W:cjbggpsaap5e9cjF;8;4;W;G;ab9:9cU1:Ng8Jcitpbi:q:G:cjbp9UpmbedilvorzHOACXQLpPahaap9spklbagaocwffa8JRb:q:W:cjbfhoxdkaiczfaopbbbpklbaoczfhoxekaiczfaopbbdaoRbbggcitpbi:q:G:cjbagRb:q:W:cjbggpsaoRbeg8Jcitpbi:q:G:cjbp9UpmbedilvorzHOACXQLpPpklbagaocdffa8JRb:q:W:cjbfhokdndndndndndnaqcl4ciGarfPDbedibledibkaicafpxbbbbbbbbbbbbbbbbpklbxlkaicafaopbblaopbbbgaclp:meaapmbzeHdOiAlCvXoQrLgacdp:meaapmbzeHdOiAlCvXoQrLpxiiiiiiiiiiiiiiiip9oghpxiiiiiiiiiiiiiiiip8Jgap5b9cjF;8;4;W;G;ab9:9cU1:Nggcitpbi:q:G:cjbagRb:q:W:cjbggpsaap5e9cjF;8;4;W;G;ab9:9cU1:Ng8Jcitpbi:q:G:cjbp9UpmbedilvorzHOACXQLpPahaap9spklbagaoclffa8JRb:q:W:cjbfhoxikaicafaopbbwaopbbbgaclp:meaapmbzeHdOiAlCvXoQrLpxssssssssssssssssp9oghpxssssssssssssssssp8Jgap5b9cjF;8;4;W;G;ab9:9cU1:Nggcitpbi:q:G:cjbagRb:q:W:cjbggpsaap5e9cjF;8;4;W;G;ab9:9cU1:Ng8Jcitpbi:q:G:cjbp9UpmbedilvorzHOACXQLpPahaap9spklbagaocwffa8JRb:q:W:cjbfhoxdkaicafaopbbbpklbaoczfhoxekaicafaopbbdaoRbbggcitpbi:q:G:cjbagRb:q:W:cjbggpsaoRbeg8Jcitpbi:q:G:cjbp9UpmbedilvorzHOACXQLpPpklbagaocdffa8JRb:q:W:cjbfhokdndndndndndnaqco4arfPDbedibledibkaic8Wfpxbbbbbbbbbbbbbbbbpklbxlkaic8Wfaopbblaopbbbgaclp:meaapmbzeHdOiAlCvXoQrLgacdp:meaapmbzeHdOiAlCvXoQrLpxiiiiiiiiiiiiiiiip9oghpxiiiiiiiiiiiiiiiip8Jgap5b9cjF;8;4;W;G;ab9:9cU1:Ngicitpbi:q:G:cjbaiRb:q:W:cjbgipsaap5e9cjF;8;4;W;G;ab9:9cU1:Ngqcitpbi:q:G:cjbp9UpmbedilvorzHOACXQLpPahaap9spklbaiaoclffaqRb:q:W:cjbfhoxikaic8Wfaopbbwaopbbbgaclp:meaapmbzeHdOiAlCvXoQrLpxssssssssssssssssp9oghpxssssssssssssssssp8Jgap5b9cjF;8;4;W;G;ab9:9cU1:Ngicitpbi:q:G:cjbaiRb:q:W:cjbgipsaap5e9cjF;8;4;W;G;ab9:9cU1:Ngqcitpbi:q:G:cjbp9UpmbedilvorzHOACXQLpPahaap9spklbaiaocwffaqRb:q:W:cjbfhoxdkaic8Wfaopbbbpklbaoczfhoxekaic8WfaopbbdaoRbbgicitpbi:q:G:cjbaiRb:q:W:cjbgipsaoRbegqcitpbi:q:G:cjbp9UpmbedilvorzHOACXQLpPpklbaiaocdffaqRb:q:W:cjbfhokalc;abfhialcjefaC0meaihlaxao9Rc;Fb0mbkkdnaiaC9pmbaici4hlinaxao9RcK6mwa8FaifhqdndndndndndnaQaico4fRbbalcoG4ciGarfPDbedibledibkaqpxbbbbbbbbbbbbbbbbpkbbxlkaqaopbblaopbbbgaclp:meaapmbzeHdOiAlCvXoQrLgacdp:meaapmbzeHdOiAlCvXoQrLpxiiiiiiiiiiiiiiiip9oghpxiiiiiiiiiiiiiiiip8Jgap5b9cjF;8;4;W;G;ab9:9cU1:Nggcitpbi:q:G:cjbagRb:q:W:cjbggpsaap5e9cjF;8;4;W;G;ab9:9cU1:Ng8Jcitpbi:q:G:cjbp9UpmbedilvorzHOACXQLpPahaap9spkbbagaoclffa8JRb:q:W:cjbfhoxikaqaopbbwaopbbbgaclp:meaapmbzeHdOiAlCvXoQrLpxssssssssssssssssp9oghpxssssssssssssssssp8Jgap5b9cjF;8;4;W;G;ab9:9cU1:Nggcitpbi:q:G:cjbagRb:q:W:cjbggpsaap5e9cjF;8;4;W;G;ab9:9cU1:Ng8Jcitpbi:q:G:cjbp9UpmbedilvorzHOACXQLpPahaap9spkbbagaocwffa8JRb:q:W:cjbfhoxdkaqaopbbbpkbbaoczfhoxekaqaopbbdaoRbbggcitpbi:q:G:cjbagRb:q:W:cjbggpsaoRbeg8Jcitpbi:q:G:cjbp9UpmbedilvorzHOACXQLpPpkbbagaocdffa8JRb:q:W:cjbfhokalcdfhlaiczfgiaC6mbkkaohQaoTmoka8FaCfh8Fa8Ecefg8Ecl9hmbkdndndndnawTmbazaEcd4fRbbglciGPlbedwbkaCTmdaXaEfhlavaEfpbdbh8Kcbhoinalavcj;cbfaofpblbg8La8Aaofpblbg8MpmbzeHdOiAlCvXoQrLg8NaKaofpblbgyaYaofpblbg8PpmbzeHdOiAlCvXoQrLgIpmbezHdiOAlvCXorQLgacep9Taapxeeeeeeeeeeeeeeeeghp9op9Hp9rgaa8Kp9Ug8Kp9Abbbaladfgla8Kaaaapmlvorlvorlvorlvorp9Ug8Kp9Abbbaladfgla8KaaaapmwDqkwDqkwDqkwDqkp9Ug8Kp9Abbbaladfgla8KaaaapmxmPsxmPsxmPsxmPsp9Ug8Kp9Abbbaladfgla8Ka8NaIpmwDKYqk8AExm35Ps8E8Fgacep9Taaahp9op9Hp9rgap9Ug8Kp9Abbbaladfgla8Kaaaapmlvorlvorlvorlvorp9Ug8Kp9Abbbaladfgla8KaaaapmwDqkwDqkwDqkwDqkp9Ug8Kp9Abbbaladfgla8KaaaapmxmPsxmPsxmPsxmPsp9Ug8Kp9Abbbaladfgla8Ka8La8MpmwKDYq8AkEx3m5P8Es8Fg8Laya8PpmwKDYq8AkEx3m5P8Es8Fg8MpmbezHdiOAlvCXorQLgacep9Taaahp9op9Hp9rgap9Ug8Kp9Abbbaladfgla8Kaaaapmlvorlvorlvorlvorp9Ug8Kp9Abbbaladfgla8KaaaapmwDqkwDqkwDqkwDqkp9Ug8Kp9Abbbaladfgla8KaaaapmxmPsxmPsxmPsxmPsp9Ug8Kp9Abbbaladfgla8Ka8La8MpmwDKYqk8AExm35Ps8E8Fgacep9Taaahp9op9Hp9rgap9Ughp9Abbbaladfglahaaaapmlvorlvorlvorlvorp9Ughp9AbbbaladfglahaaaapmwDqkwDqkwDqkwDqkp9Ughp9AbbbaladfglahaaaapmxmPsxmPsxmPsxmPsp9Ug8Kp9AbbbaladfhlaoczfgoaC6mbxikkaCTmeaXaEfhlavaEfpbdbh8Kcbhoinalavcj;cbfaofpblbg8La8Aaofpblbg8MpmbzeHdOiAlCvXoQrLg8NaKaofpblbgyaYaofpblbg8PpmbzeHdOiAlCvXoQrLgIpmbezHdiOAlvCXorQLgacep:neaapxebebebebebebebebghp9op:bep9rgaa8Kp:oeg8Kp9Abbbaladfgla8Kaaaapmlvorlvorlvorlvorp:oeg8Kp9Abbbaladfgla8KaaaapmwDqkwDqkwDqkwDqkp:oeg8Kp9Abbbaladfgla8KaaaapmxmPsxmPsxmPsxmPsp:oeg8Kp9Abbbaladfgla8Ka8NaIpmwDKYqk8AExm35Ps8E8Fgacep:neaaahp9op:bep9rgap:oeg8Kp9Abbbaladfgla8Kaaaapmlvorlvorlvorlvorp:oeg8Kp9Abbbaladfgla8KaaaapmwDqkwDqkwDqkwDqkp:oeg8Kp9Abbbaladfgla8KaaaapmxmPsxmPsxmPsxmPsp:oeg8Kp9Abbbaladfgla8Ka8La8MpmwKDYq8AkEx3m5P8Es8Fg8Laya8PpmwKDYq8AkEx3m5P8Es8Fg8MpmbezHdiOAlvCXorQLgacep:neaaahp9op:bep9rgap:oeg8Kp9Abbbaladfgla8Kaaaapmlvorlvorlvorlvorp:oeg8Kp9Abbbaladfgla8KaaaapmwDqkwDqkwDqkwDqkp:oeg8Kp9Abbbaladfgla8KaaaapmxmPsxmPsxmPsxmPsp:oeg8Kp9Abbbaladfgla8Ka8La8MpmwDKYqk8AExm35Ps8E8Fgacep:neaaahp9op:bep9rgap:oeghp9Abbbaladfglahaaaapmlvorlvorlvorlvorp:oeghp9AbbbaladfglahaaaapmwDqkwDqkwDqkwDqkp:oeghp9AbbbaladfglahaaaapmxmPsxmPsxmPsxmPsp:oeg8Kp9AbbbaladfhlaoczfgoaC6mbxdkkaCTmbaXaEfhrcbhocbalcl4gl9Rc8FGhiavaEfpbdbhhinaravcj;cbfaofpblbg8Ka8Aaofpblbg8LpmbzeHdOiAlCvXoQrLg8MaKaofpblbg8NaYaofpblbgypmbzeHdOiAlCvXoQrLg8PpmbezHdiOAlvCXorQLgaaip:Reaaalp:Tep9qgaahp9rghp9Abbbaradfgrahaaaapmlvorlvorlvorlvorp9rghp9AbbbaradfgrahaaaapmwDqkwDqkwDqkwDqkp9rghp9AbbbaradfgrahaaaapmxmPsxmPsxmPsxmPsp9rghp9Abbbaradfgraha8Ma8PpmwDKYqk8AExm35Ps8E8Fgaaip:Reaaalp:Tep9qgap9rghp9Abbbaradfgrahaaaapmlvorlvorlvorlvorp9rghp9AbbbaradfgrahaaaapmwDqkwDqkwDqkwDqkp9rghp9AbbbaradfgrahaaaapmxmPsxmPsxmPsxmPsp9rghp9Abbbaradfgraha8Ka8LpmwKDYq8AkEx3m5P8Es8Fg8Ka8NaypmwKDYq8AkEx3m5P8Es8Fg8LpmbezHdiOAlvCXorQLgaaip:Reaaalp:Tep9qgap9rghp9Abbbaradfgrahaaaapmlvorlvorlvorlvorp9rghp9AbbbaradfgrahaaaapmwDqkwDqkwDqkwDqkp9rghp9AbbbaradfgrahaaaapmxmPsxmPsxmPsxmPsp9rghp9Abbbaradfgraha8Ka8LpmwDKYqk8AExm35Ps8E8Fgaaip:Reaaalp:Tep9qgap9rghp9Abbbaradfgrahaaaapmlvorlvorlvorlvorp9rghp9AbbbaradfgrahaaaapmwDqkwDqkwDqkwDqkp9rghp9AbbbaradfgrahaaaapmxmPsxmPsxmPsxmPsp9rghp9AbbbaradfhraoczfgoaC6mbkkaEclfgEad6mbkdnaXavcjdf9hmbaAad2goTmbaOavcjdfao;8qbbkdnammbavaXaAcufad2fad;8qbbkaAaHfhHc9:hoaQhPaQmbxlkkaeTmbaDalfhrcbhocuhlinaralaD9RglfaD6mdasaeao9Raoasfae6Eaofgoae6mbkaial9RhPkcbc99axaP9RakSEhoxekc9:hokavcj;kbf8Kjjjjbaokwbz:bjjjbkpPesu8Jjjjjbc;ae9Rgv8Kjjjjbc9:hodnalaeci9UgrcHf6mbcuhoaiRbbgwc;WeGc;Ge9hmbawcsGgwce0mbavc;abfcFecje;8kbav9cu83iUav9cu83i8Wav9cu83iyav9cu83iaav9cu83iKav9cu83izav9cu83iwav9cu83ibaialfc9WfhDaicefgiarfhqdndnaeci9pmbaqhexekcmcsawceSEhkcbhxcbhmaqhecbhlcbhoindndnaiRbbgrc;Ve0mbavc;abfaoarcu7gPcl4fcsGcitfgwydlhsawydbhzdndnarcsGgwak9pmbavalaPfcsGcdtfydbaxawEhraxawTgHfhxxekdnaeaD9nmbc9:hoxokdndnawcsSmbcehHamawcetfcWfhrxekaecefhrae8SbbgwcFeGhPdndnawcu9mmbarhexekaecvfheaPcFbGhPcrhwdninar8SbbgHcFbGawtaPVhPaHcu9kmearcefhrawcrfgwc8J9hmbxdkkarcefhekcehHaPce4cbaPceG9R7amfhrkarhmkavc;abfaocitfgwarBdbawasBdlavalcdtfarBdbavc;abfaocefcsGcitfgwazBdbawarBdlaocdfhoaHalfhldnadcd9hmbabar87elabas87edabaz87ebabcofhbxdkabarBdwabasBdlabazBdbabcxfhbxekdnarcpe0mbavalaDarcsGfRbbgwcl4gP9RcsGcdtfydbaxcefgsaPEhravalaw9RcsGcdtfydbasaPTgzfgsawcsGgPEhwaPThPdndnadcd9hmbabaw87elabar87edabax87ebcohHxekabawBdwabarBdlabaxBdbcxhHkavalcdtfaxBdbavc;abfaocitfgOarBdbaOaxBdlavalcefglcsGcdtfarBdbavc;abfaocefcsGcitfgOawBdbaOarBdlavalazfglcsGcdtfawBdbavc;abfaocdfcsGcitfgraxBdbarawBdlaocifhoabaHfhbalaPfhlasaPfhxxekdnaeaD9nmbc9:hoxlkaxcbaeRbbgwEgHarc;:eSgrfhsawcsGhOdndnawcl4gAmbascefhzxekashzavalaA9RcsGcdtfydbhskdndnaOmbazcefhxxekazhxavalaw9RcsGcdtfydbhzkdndnarTmbaecefhrxekaecdfhrae8SbegPcFeGhwdnaPcu9kmbaecofhHawcFbGhwcrhedninar8SbbgPcFbGaetawVhwaPcu9kmearcefhraecrfgec8J9hmbkaHhrxekarcefhrkawce4cbawceG9R7amfgmhHkdndnaAcsSmbarhwxekarcefhwar8SbbgecFeGhPdnaecu9kmbarcvfhsaPcFbGhPcrhedninaw8SbbgrcFbGaetaPVhParcu9kmeawcefhwaecrfgec8J9hmbkashwxekawcefhwkaPce4cbaPceG9R7amfgmhskdndnaOcsSmbawhexekawcefheaw8SbbgrcFeGhPdnarcu9kmbawcvfhzaPcFbGhPcrhrdninae8SbbgwcFbGartaPVhPawcu9kmeaecefhearcrfgrc8J9hmbkazhexekaecefhekaPce4cbaPceG9R7amfgmhzkdndnadcd9hmbabaz87elabas87edabaH87ebcohrxekabazBdwabasBdlabaHBdbcxhrkavc;abfaocitfgwasBdbawaHBdlavalcdtfaHBdbavc;abfaocefcsGcitfgwazBdbawasBdlavalcefglcsGcdtfasBdbavc;abfaocdfcsGcitfgwaHBdbawazBdlavalaATaAcsSVfglcsGcdtfazBdbalaOTaOcsSVfhlaocifhoabarfhbkaocsGhoalcsGhlaicefgiaq6mbkkcbc99aeaDSEhokavc;aef8Kjjjjbaok:clevu8Jjjjjbcz9Rhvdnalaecvf9pmbc9:skdnaiRbbc;:eGc;qeSmbcuskav9cb83iwaicefhoaialfc98fhrdnaeTmbdnadcdSmbcbhwindnaoar6mbc9:skaocefhlao8SbbgicFeGhddndnaicu9mmbalhoxekaocvfhoadcFbGhdcrhidninal8SbbgDcFbGaitadVhdaDcu9kmealcefhlaicrfgic8J9hmbxdkkalcefhokabawcdtfadc8Etc8F91adcd47avcwfadceGcdtVglydbfgiBdbalaiBdbawcefgwae9hmbxdkkcbhwindnaoar6mbc9:skaocefhlao8SbbgicFeGhddndnaicu9mmbalhoxekaocvfhoadcFbGhdcrhidninal8SbbgDcFbGaitadVhdaDcu9kmealcefhlaicrfgic8J9hmbxdkkalcefhokabawcetfadc8Etc8F91adcd47avcwfadceGcdtVglydbfgi87ebalaiBdbawcefgwae9hmbkkcbc99aoarSEk;Toio97eue97aec98Ghedndnadcl9hmbaeTmecbhdinababpbbbgicKp:RecKp:Sep;6eglaicwp:RecKp:Sep;6ealp;Geaiczp:RecKp:Sep;6egvp;Gep;Kep;Legopxbbbbbbbbbbbbbbbbp:2egralpxbbbjbbbjbbbjbbbjgwp9op9rp;Keglpxbb;:9cbb;:9cbb;:9cbb;:9calalp;Meaoaop;Meavaravawp9op9rp;Keglalp;Mep;Kep;Kep;Jep;Negvp;Mepxbbn0bbn0bbn0bbn0grp;KepxFbbbFbbbFbbbFbbbp9oaipxbbbFbbbFbbbFbbbFp9op9qalavp;Mearp;Kecwp:RepxbFbbbFbbbFbbbFbbp9op9qaoavp;Mearp;Keczp:RepxbbFbbbFbbbFbbbFbp9op9qpkbbabczfhbadclfgdae6mbxdkkaeTmbcbhdinabczfgDaDpbbbgipxbbbbbbFFbbbbbbFFgwp9oabpbbbgoaipmbediwDqkzHOAKY8AEgvczp:Reczp:Sep;6eglaoaipmlvorxmPsCXQL358E8FpxFubbFubbFubbFubbp9op;6eavczp:Sep;6egvp;Gealp;Gep;Kep;Legipxbbbbbbbbbbbbbbbbp:2egralpxbbbjbbbjbbbjbbbjgqp9op9rp;Keglpxb;:FSb;:FSb;:FSb;:FSalalp;Meaiaip;Meavaravaqp9op9rp;Keglalp;Mep;Kep;Kep;Jep;Negvp;Mepxbbn0bbn0bbn0bbn0grp;KepxFFbbFFbbFFbbFFbbp9oaiavp;Mearp;Keczp:Rep9qgialavp;Mearp;KepxFFbbFFbbFFbbFFbbp9oglpmwDKYqk8AExm35Ps8E8Fp9qpkbbabaoawp9oaialpmbezHdiOAlvCXorQLp9qpkbbabcafhbadclfgdae6mbkkk;2ileue97euo97dnaec98GgiTmbcbheinabcKfpx:ji:1S:ji:1S:ji:1S:ji:1SabpbbbglabczfgvpbbbgopmlvorxmPsCXQL358E8Fgrczp:Segwpxibbbibbbibbbibbbp9qp;6egDp;NegqaDaDp;MegDaDp;KealaopmbediwDqkzHOAKY8AEgDczp:Reczp:Sep;6eglalp;MeaDczp:Sep;6egoaop;Mearczp:Reczp:Sep;6egrarp;Mep;Kep;Kep;Lepxbbbbbbbbbbbbbbbbp:4ep;Jep;Mepxbbn0bbn0bbn0bbn0gDp;KepxFFbbFFbbFFbbFFbbgkp9oaqaop;MeaDp;Keczp:Rep9qgoaqalp;MeaDp;Keakp9oaqarp;MeaDp;Keczp:Rep9qgDpmwDKYqk8AExm35Ps8E8Fglp5eawclp:RegqpEi:T:j83ibavalp5baqpEd:T:j83ibabcwfaoaDpmbezHdiOAlvCXorQLgDp5eaqpEe:T:j83ibabaDp5baqpEb:T:j83ibabcafhbaeclfgeai6mbkkkuee97dnadcd4ae2c98GgeTmbcbhdinababpbbbgicwp:Recwp:Sep;6eaicep:SepxbbjFbbjFbbjFbbjFp9opxbbjZbbjZbbjZbbjZp:Uep;Mepkbbabczfhbadclfgdae6mbkkk:Sodw97euaec98Ghedndnadcl9hmbaeTmecbhdinabpxbbuJbbuJbbuJbbuJabpbbbgicKp:TeglaicYp:Tep9qgvcdp:Teavp9qgvclp:Teavp9qgop;6ep;Negvaicwp:RecKp:SegraipxFbbbFbbbFbbbFbbbgwp9ogDp:Uep;6ep;Mepxbbn0bbn0bbn0bbn0gqp;Kecwp:RepxbFbbbFbbbFbbbFbbp9oavaDarp:Xeaiczp:RecKp:Segip:Uep;6ep;Meaqp;Keawp9op9qavaDaraip:Uep:Xep;6ep;Meaqp;Keczp:RepxbbFbbbFbbbFbbbFbp9op9qavaoalcep:Rep9oalpxebbbebbbebbbebbbp9op9qp;6ep;Meaqp;KecKp:Rep9qpkbbabczfhbadclfgdae6mbxdkkaeTmbcbhdinabczfgkpxbFu9hbFu9hbFu9hbFu9habpbbbglakpbbbgrpmlvorxmPsCXQL358E8Fgvczp:TegqavcHp:Tep9qgicdp:Teaip9qgiclp:Teaip9qgicwp:Teaip9qgop;6ep;NegialarpmbediwDqkzHOAKY8AEgDpxFFbbFFbbFFbbFFbbglp9ograDczp:Segwp:Ueavczp:Reczp:SegDp:Xep;6ep;Mepxbbn0bbn0bbn0bbn0gvp;Kealp9oaiarawaDp:Uep:Xep;6ep;Meavp;Keczp:Rep9qgwaiaoaqcep:Rep9oaqpxebbbebbbebbbebbbp9op9qp;6ep;Meavp;Keczp:ReaiaDarp:Uep;6ep;Meavp;Kealp9op9qgipmwDKYqk8AExm35Ps8E8FpkbbabawaipmbezHdiOAlvCXorQLpkbbabcafhbadclfgdae6mbkkk9teiucbcbydj:G:cjbgeabcifc98GfgbBdj:G:cjbdndnabZbcztgd9nmbcuhiabad9RcFFifcz4nbcuSmekaehikaikkxebcj:Gdklz:zbb",d=new Uint8Array([0,97,115,109,1,0,0,0,1,4,1,96,0,0,3,3,2,0,0,5,3,1,0,1,12,1,0,10,22,2,12,0,65,0,65,0,65,0,252,10,0,0,11,7,0,65,0,253,15,26,11]),g=new Uint8Array([32,0,65,2,1,106,34,33,3,128,11,4,13,64,6,253,10,7,15,116,127,5,8,12,40,16,19,54,20,9,27,255,113,17,42,67,24,23,146,148,18,14,22,45,70,69,56,114,101,21,25,63,75,136,108,28,118,29,73,115]);if(typeof WebAssembly!="object")return{supported:!1};var n=WebAssembly.validate(d)?f(e):f(a),p,h=WebAssembly.instantiate(n,{}).then(function(s){p=s.instance,p.exports.__wasm_call_ctors()});function f(s){for(var r=new Uint8Array(s.length),c=0;c<s.length;++c){var b=s.charCodeAt(c);r[c]=b>96?b-97:b>64?b-39:b+4}for(var o=0,c=0;c<s.length;++c)r[o++]=r[c]<60?g[r[c]]:(r[c]-60)*64+r[++c];return r.buffer.slice(0,o)}function i(s,r,c,b,o,k,G){var v=s.exports.sbrk,A=b+3&-4,q=v(A*o),j=v(k.length),F=new Uint8Array(s.exports.memory.buffer);F.set(k,j);var E=r(q,b,o,j,k.length);if(E==0&&G&&G(q,A,o),c.set(F.subarray(q,q+b*o)),v(q-v(0)),E!=0)throw new Error("Malformed buffer data: "+E)}var w={NONE:"",OCTAHEDRAL:"meshopt_decodeFilterOct",QUATERNION:"meshopt_decodeFilterQuat",EXPONENTIAL:"meshopt_decodeFilterExp",COLOR:"meshopt_decodeFilterColor"},m={ATTRIBUTES:"meshopt_decodeVertexBuffer",TRIANGLES:"meshopt_decodeIndexBuffer",INDICES:"meshopt_decodeIndexSequence"},t=[],l=0;function x(s){var r={object:new Worker(s),pending:0,requests:{}};return r.object.onmessage=function(c){var b=c.data;r.pending-=b.count,r.requests[b.id][b.action](b.value),delete r.requests[b.id]},r}function K(s){for(var r="self.ready = WebAssembly.instantiate(new Uint8Array(["+new Uint8Array(n)+"]), {}).then(function(result) { result.instance.exports.__wasm_call_ctors(); return result.instance; });self.onmessage = "+u.name+";"+i.toString()+u.toString(),c=new Blob([r],{type:"text/javascript"}),b=URL.createObjectURL(c),o=t.length;o<s;++o)t[o]=x(b);for(var o=s;o<t.length;++o)t[o].object.postMessage({});t.length=s,URL.revokeObjectURL(b)}function D(s,r,c,b,o){for(var k=t[0],G=1;G<t.length;++G)t[G].pending<k.pending&&(k=t[G]);return new Promise(function(v,A){var q=new Uint8Array(c),j=++l;k.pending+=s,k.requests[j]={resolve:v,reject:A},k.object.postMessage({id:j,count:s,size:r,source:q,mode:b,filter:o},[q.buffer])})}function u(s){var r=s.data;self.ready.then(function(c){if(!r.id)return self.close();try{var b=new Uint8Array(r.count*r.size);i(c,c.exports[r.mode],b,r.count,r.size,r.source,c.exports[r.filter]),self.postMessage({id:r.id,count:r.count,action:"resolve",value:b},[b.buffer])}catch(o){self.postMessage({id:r.id,count:r.count,action:"reject",value:o})}})}return{ready:h,supported:!0,useWorkers:function(s){K(s)},decodeVertexBuffer:function(s,r,c,b,o){i(p,p.exports.meshopt_decodeVertexBuffer,s,r,c,b,p.exports[w[o]])},decodeIndexBuffer:function(s,r,c,b){i(p,p.exports.meshopt_decodeIndexBuffer,s,r,c,b)},decodeIndexSequence:function(s,r,c,b){i(p,p.exports.meshopt_decodeIndexSequence,s,r,c,b)},decodeGltfBuffer:function(s,r,c,b,o,k){i(p,p.exports[m[o]],s,r,c,b,p.exports[w[k]])},decodeGltfBufferAsync:function(s,r,c,b,o){return t.length>0?D(s,r,c,m[b],w[o]):h.then(function(){var k=new Uint8Array(s*r);return i(p,p.exports[m[b]],k,s,r,c,p.exports[w[o]]),k})}}})();async function U(a,e){if(!J.supported)throw new R("browser","has no WebAssembly, which walks need");await J.ready;let d=0,g=h=>a.subarray(d,d+=h.bytes),n=(h,f)=>{let i=new Uint8Array(f*h.count),w=g(h);return h.count>0&&J.decodeVertexBuffer(i,h.count,f,w),i},p=(h,f)=>{let i=new Uint32Array(h.count),w=g(h);h.count>0&&J.decodeIndexBuffer(new Uint8Array(i.buffer),h.count,4,w);for(let m=0;m<i.length;++m)if(i[m]>=f)throw new R(e.name,"names a vertex that there is not");return i};try{let h=n(e.surfaceVertices,8),f=p(e.surfaceIndices,e.surfaceVertices.count),i=n(e.skinVertices,16),w=p(e.skinIndices,e.skinVertices.count),m=new Float64Array(12);for(let l=0;l<6;++l)m[2*l]=1/0,m[2*l+1]=-1/0;let t=(l,x,K,D)=>{let u=new Uint16Array(l.buffer,l.byteOffset,l.length/2),s=0;for(let r=0;r<6;++r)for(let c=s+3*D[r];s<c;++s){let b=u[K[s]*x/2+3]*e.disparityStep;m[2*r]=Math.min(m[2*r],b),m[2*r+1]=Math.max(m[2*r+1],b)}};return t(h,8,f,e.surfaces),t(i,16,w,e.skins),{surfaceVertices:h,surfaceIndices:f,skinVertices:i,skinIndices:w,reaches:m}}catch(h){throw h instanceof R?h:new R(e.name,"is damaged")}}async function Q(a,e){if(typeof DecompressionStream>"u")throw new R("browser","has no DecompressionStream, which walks need: update it");try{let d=new Blob([a]).stream().pipeThrough(new DecompressionStream("deflate"));return new Uint8Array(await new Response(d).arrayBuffer())}catch{throw new R(e,"is damaged")}}async function W(a,e,d,g){let n=await Q(a,g),p=e*d;if(n.length!==1+2*p||n[0]>2)throw new R(g,"is damaged or has another size");let h=n[0],f=new Uint16Array(p);for(let i=0,w=0;i<d;++i)for(let m=0;m<e;++m,++w){let t=n[1+w]|n[1+p+w]<<8,l=t>>1^-(t&1);if(h>0){let x=m>0?f[w-1]:0,K=i>0?f[w-e]:0,D=x+K-(m>0&&i>0?f[w-e-1]:0);l+=h===1?D:Math.min(Math.max(D,Math.min(x,K)),Math.max(x,K))}f[w]=l}return f}var T=new Uint32Array(64),O=new Uint32Array(8);{let a=0;for(let e=2;a<64;++e){let d=!0;for(let n=2;n*n<=e&&d;++n)d=e%n!==0;if(!d)continue;let g=n=>(n-Math.floor(n))*4294967296>>>0;T[a]=g(Math.cbrt(e)),a<8&&(O[a]=g(Math.sqrt(e))),++a}}var P=(a,e)=>a>>>e|a<<32-e;function M(a,e,d,g){for(let l=0;l<16;++l)e[l]=d.getUint32(g+4*l);for(let l=16;l<64;++l){let x=e[l-15],K=e[l-2];e[l]=e[l-16]+(P(x,7)^P(x,18)^x>>>3)+e[l-7]+(P(K,17)^P(K,19)^K>>>10)}let[n,p,h,f,i,w,m,t]=a;for(let l=0;l<64;++l){let x=t+(P(i,6)^P(i,11)^P(i,25))+(i&w^~i&m)+T[l]+e[l]|0,K=(P(n,2)^P(n,13)^P(n,22))+(n&p^n&h^p&h)|0;t=m,m=w,w=i,i=f+x|0,f=h,h=p,p=n,n=x+K|0}a[0]+=n,a[1]+=p,a[2]+=h,a[3]+=f,a[4]+=i,a[5]+=w,a[6]+=m,a[7]+=t}function V(a){let e=O.slice(),d=new Uint32Array(64),g=new DataView(a.buffer,a.byteOffset,a.byteLength),n=a.length-a.length%64;for(let i=0;i<n;i+=64)M(e,d,g,i);let p=a.length-n,h=new Uint8Array(p<56?64:128);h.set(a.subarray(n)),h[p]=128;let f=new DataView(h.buffer);f.setUint32(h.length-8,Math.floor(a.length/536870912)),f.setUint32(h.length-4,a.length<<3>>>0);for(let i=0;i<h.length;i+=64)M(e,d,f,i);return Array.from(e,i=>i.toString(16).padStart(8,"0")).join("")}function Y(a,e){let d=[],g=0,n=4;for(let p=0;p<4;++p,n*=4)d.push(g),g+=Math.ceil(a/n);return{columns:g,rows:Math.ceil(e/4),levelAt:d}}var y=new Float32Array(1),I=new Uint32Array(y.buffer);function z(a){y[0]=a;let e=I[0],d=e>>>16&32768,g=(e>>>23&255)-112;if(g>=31)return d|31743;if(g>0){let n=g<<10|e>>>13&1023,p=e&8191;return d|Math.min(31743,n+(p>4096||p===4096&&n&1?1:0))}return g<-10?d:d|Math.round(Math.abs(y[0])*16777216)}function H(a,e){let{width:d,height:g,sigma:n,links:p}=e;if(!p)return{codes:a,slopes:new Uint32Array,links:new Uint8Array,cells:new Float32Array};let h=d*g,f=new Float32Array(h);for(let c=0;c<h;++c)f[c]=a[c]===0?0:e.least+(a[c]-1)*e.step;let i=new Uint8Array(h),w=(c,b,o,k,G)=>{let v=1/f[c],A=1/f[b],q=Math.abs(A-v)/(G*Math.min(v,A));if(q<=p.gentle)return!0;if(q>p.steepest)return!1;let j=f[b]-f[c],F=j<0?-1:1,E=0;return o>=0&&f[o]>0&&(E=Math.max(E,F*(f[c]-f[o]))),k>=0&&f[k]>0&&(E=Math.max(E,F*(f[k]-f[b]))),F*j<=p.growth*E};for(let c=0,b=0;c<g;++c)for(let o=0;o<d;++o,++b)f[b]!==0&&(o+1<d&&f[b+1]>0&&w(b,b+1,o>0?b-1:-1,o+2<d?b+2:-1,e.du)&&(i[b]|=1,i[b+1]|=16),c+1<g&&f[b+d]>0&&w(b,b+d,c>0?b-d:-1,c+2<g?b+2*d:-1,e.dv)&&(i[b]|=4,i[b+d]|=64));let m=new Uint32Array(2*h),t=Y(d,g),l=new Float32Array(t.columns*t.rows).fill(-1e30),x=new Float32Array(t.columns*t.rows).fill(1e30),K=new Uint8Array(t.columns*t.rows),D=[1,d,-1,-d],u=[0,0,0,0];for(let c=0,b=0;c<g;++c)for(let o=0;o<d;++o,++b){let k=(c>>2)*t.columns+(o>>2);if(f[b]===0){K[k]=1;continue}for(let j=0;j<4;++j)u[j]=i[b]>>2*j&1?f[b+D[j]]-f[b]:0;for(let j=0;j<4;++j){let F=(j+2)%4;if(i[b]>>2*j&1||!(i[b]>>2*F&1))continue;let E=2*(j%2===0?e.du:e.dv)*f[b];u[j]=Math.max(-E,Math.min(E,-u[F]))}m[2*b]=z(u[0])|z(u[1])<<16,m[2*b+1]=z(u[2])|z(u[3])<<16;let G=f[b]+.5*(Math.min(0,u[0],u[2])+Math.min(0,u[1],u[3])),v=f[b]+.5*(Math.max(0,u[0],u[2])+Math.max(0,u[1],u[3])),A=n>0?v:-G,q=n>0?G:-v;l[k]=Math.max(l[k],A+1e-6*Math.abs(A)),x[k]=Math.min(x[k],q-1e-6*Math.abs(q))}let s=Math.min(e.du,e.dv);for(let c=0;c+1<g;++c)for(let b=0;b+1<d;++b){let o=c*d+b,k=o+1,G=o+d,v=G+1;i[o]&1&&i[o]&4&&i[v]&16&&i[v]&64&&Math.abs(f[o]+f[v]-f[k]-f[G])<=.5*s*f[o]&&(i[o]|=2,i[k]|=8,i[v]|=32,i[G]|=128)}for(let c=1,b=4;c<4;++c,b*=4){let o=t.levelAt[c-1],k=t.levelAt[c],G=Math.ceil(d/b),v=Math.ceil(g/b);for(let A=0;A<v;++A)for(let q=0;q<G;++q){let j=A*t.columns+o+q,F=(A>>2)*t.columns+k+(q>>2);l[F]=Math.max(l[F],l[j]),x[F]=Math.min(x[F],x[j]),K[F]|=K[j]}}let r=new Float32Array(2*l.length);for(let c=0;c<l.length;++c)r[2*c]=l[c],r[2*c+1]=Math.abs(x[c])*(K[c]?-1:1);return{codes:a,slopes:m,links:i,cells:r}}function Z(a,e){let d=/([0-9a-f]+)\\.\\w+$/.exec(e)?.[1]??"";if(!V(a).startsWith(d)||d.length<16)throw new R(e,"has not the contents that its name says: it is damaged, or of another walk")}async function B(a){let e=new Uint8Array(a.bytes);switch(Z(e,a.kind==="mesh"?a.entry.name:a.name),a.kind){case"check":return a.bytes;case"mesh":return U(e,a.entry);case"plane16":return W(e,a.width,a.height,a.name);case"view":return H(await W(e,a.of.width,a.of.height,a.name),a.of);case"shares":{let d=await W(e,a.width,a.height,a.name);return Uint8Array.from(d,g=>Math.min(255,Math.round(255*g/a.steps)))}}}function N(a){return a instanceof ArrayBuffer?[a]:a instanceof Uint16Array||a instanceof Uint8Array?[a.buffer]:Object.values(a).map(e=>e.buffer)}var S=self;S.onmessage=async a=>{let{id:e,job:d}=a.data;try{let g=await B(d);S.postMessage({id:e,result:g},N(g))}catch(g){let{where:n,reason:p}=L(g,"worker");S.postMessage({id:e,error:{where:n,reason:p}})}};})();\n';var _=class extends Error{constructor(a,t){super(`${a}: ${t}`);this.where=a;this.reason=t;this.name="WalkError"}};function U(s,e){return s instanceof _?s:new _(e,s instanceof Error?s.message:String(s))}var I=class{constructor(){this.waiting=new Map;this.next=1;this.failed=null;let e=URL.createObjectURL(new Blob([le],{type:"text/javascript"}));this.worker=new Worker(e),this.worker.onmessage=a=>{URL.revokeObjectURL(e);let{id:t,result:i,error:r}=a.data,o=this.waiting.get(t);this.waiting.delete(t),r?o?.reject(new _(r.where,r.reason)):o?.resolve(i)},this.worker.onerror=a=>{a.preventDefault(),this.fail(new _("browser","does not start the worker that decodes pictures: the page's Content-Security-Policy must allow worker-src blob:"))}}async check(e,a){return await this.run({kind:"check",bytes:e,name:a.name})}async mesh(e,a){return await this.run({kind:"mesh",bytes:e,entry:a})}async view(e,a,t){return await this.run({kind:"view",bytes:e,name:a.name,of:t})}async shares(e,a,t,i){let{name:r,steps:o}=a;return await this.run({kind:"shares",bytes:e,name:r,width:t,height:i,steps:o})}async plane16(e,a,t,i){return await this.run({kind:"plane16",bytes:e,name:a.name,width:t,height:i})}dispose(){this.worker.terminate(),this.fail(new _("walk","was disposed of"))}fail(e){this.failed=e;for(let a of this.waiting.values())a.reject(e);this.waiting.clear()}run(e){return new Promise((a,t)=>{if(this.failed){t(this.failed);return}let i=this.next++;this.waiting.set(i,{resolve:a,reject:t}),this.worker.postMessage({id:i,job:e},[e.bytes])})}};var Ve=`#version 300 es
precision highp float;
layout(location = 0) in vec3 direction;
layout(location = 1) in float disparity;
#ifdef SKIN
layout(location = 2) in vec3 texture_direction;
layout(location = 3) in float stretch;
out float v_stretch;
#endif
uniform mat4 clip_from_node;
uniform vec4 scales;
out vec3 v_direction;
#ifdef UNMIXES
out float v_disparity;
#endif
void main() {
vec4 place = vec4(direction * scales.x, disparity * scales.y);
vec4 clip = clip_from_node * place;
clip.z = clip.w - scales.w * place.w;
gl_Position = clip;
#ifdef SKIN
v_direction = texture_direction * scales.z;
v_stretch = (stretch - 1.0) * 0.125;
#else
v_direction = place.xyz;
#endif
#ifdef UNMIXES
v_disparity = disparity;
#endif
}
`,he=`int face_of(vec3 d, out vec2 st) {
vec3 a = abs(d);
if (a.x >= a.y && a.x >= a.z) {
st = vec2(d.x > 0.0 ? -d.z : d.z, -d.y) / a.x;
return d.x > 0.0 ? 0 : 1;
}
if (a.y >= a.z) {
st = vec2(d.x, d.y > 0.0 ? d.z : -d.z) / a.y;
return d.y > 0.0 ? 2 : 3;
}
st = vec2(d.z > 0.0 ? d.x : -d.x, -d.y) / a.z;
return d.z > 0.0 ? 4 : 5;
}
`,Ce=`#version 300 es
precision highp float;
precision highp int;
precision highp usampler2D;
in vec3 v_direction;
#ifdef SKIN
in float v_stretch;
uniform float widest_skin;
#endif
uniform samplerCube faces;
#ifdef UNMIXES
in float v_disparity;
uniform usampler2D seen;
uniform float unmix;
float disparity_at(ivec2 texel) {
uint code = texelFetch(seen, texel, 0).r;
return code == 0u ? -1.0 : unpackHalf2x16(code - 1u).x;
}
vec4 texel_at(vec3 d) { return textureLod(faces, d, 0.0); }
vec3 surface_color(vec3 mixed) {
vec3 a = abs(v_direction);
float ahead = max(a.x, max(a.y, a.z));
vec3 d = v_direction / ahead, s = vec3(1.0, 0.0, 0.0), t = vec3(0.0, -1.0, 0.0);
int face = d.z > 0.0 ? 4 : 5;
if (ahead == a.x) {
face = d.x > 0.0 ? 0 : 1;
s = vec3(0.0, 0.0, -d.x);
} else if (ahead == a.y) {
face = d.y > 0.0 ? 2 : 3;
t = vec3(0.0, 0.0, d.y);
} else {
s.x = d.z;
}
int size = textureSize(faces, 0).x;
vec2 at = (0.5 * vec2(dot(d, s), dot(d, t)) + 0.5) * float(size) - 0.5, low = floor(at);
vec2 far = at - low, near = 1.0 - far;
s *= 2.0 / float(size);
t *= 2.0 / float(size);
d -= far.x * s + far.y * t;
vec4 c0 = texel_at(d), c1 = texel_at(d + s), c2 = texel_at(d + t), c3 = texel_at(d + s + t);
if (min(min(c0.a, c1.a), min(c2.a, c3.a)) > 0.0) return mixed;
ivec2 corner = ivec2(face % 3, face / 3) * size, last = ivec2(size - 1);
ivec2 p = corner + clamp(ivec2(low), ivec2(0), last);
ivec2 q = corner + clamp(ivec2(low) + 1, ivec2(0), last);
float own = v_disparity / ahead;
vec4 off = abs(vec4(disparity_at(p), disparity_at(ivec2(q.x, p.y)),
disparity_at(ivec2(p.x, q.y)), disparity_at(q)) - own);
float least = min(min(off.x, off.y), min(off.z, off.w));
vec4 weight = vec4(near.x, far.x, near.x, far.x) * vec4(near.y, near.y, far.y, far.y);
weight = max(weight, 1e-3) * vec4(lessThanEqual(off, vec4(least + unmix * own)));
return (weight.x * c0.rgb + weight.y * c1.rgb + weight.z * c2.rgb + weight.w * c3.rgb) /
(weight.x + weight.y + weight.z + weight.w);
}
#endif
#ifdef OBJECT
uniform usampler2D objects;
layout(location = 0) out uvec4 out_object;
${he}
uint object_at(vec3 d) {
vec2 st;
int face = face_of(d, st);
int size = textureSize(objects, 0).x / 3;
ivec2 texel = clamp(ivec2(floor((0.5 * st + 0.5) * float(size))), ivec2(0), ivec2(size - 1));
return texelFetch(objects, ivec2(face % 3, face / 3) * size + texel, 0).r;
}
#else
layout(location = 0) out vec4 out_color;
#endif
void main() {
#ifdef SKIN
if (v_stretch >= 0.0 && fwidth(v_stretch) * widest_skin < 1.0) discard;
#endif
#ifdef OBJECT
out_object = uvec4(object_at(v_direction), 0u, 0u, 1u);
#elif defined(SKIN)
out_color = vec4(texture(faces, v_direction).rgb, 1.0 / 255.0);
#else
vec4 color = texture(faces, v_direction);
#ifdef UNMIXES
if (unmix >= 0.0 && color.a < 0.5) color.rgb = surface_color(color.rgb);
#endif
out_color = vec4(color.rgb, (2.0 + 253.0 * color.a) / 255.0);
#endif
}
`,te=`#version 300 es
void main() {
gl_Position = vec4(float((gl_VertexID & 1) * 4) - 1.0, float((gl_VertexID >> 1) * 4) - 1.0, 0.0,
1.0);
}
`;function K(s,e){return Array.from({length:s},(a,t)=>e(t)).join("")}function Oe(s){let e=`
uniform highp sampler2DArray node_colors;
uniform highp sampler2DArray node_depths;
uniform vec2 node_merge;
float layer_z(ivec2 pixel, int layer) {
return node_merge.y / max(1.0 - texelFetch(node_depths, ivec3(pixel, layer), 0).r, 1e-15);
}
`;return s===1?`${e}
bool merge_nodes(ivec2 pixel, out vec3 color, out float eye_z) {
vec4 shown = texelFetch(node_colors, ivec3(pixel, 0), 0);
color = shown.rgb;
eye_z = layer_z(pixel, 0);
return shown.a > 0.0;
}
`:`${e}
uniform float node_nearness[${s}];
uniform float node_steps[${s}];
uniform mat4 node_from_eye[${s}];
uniform vec4 node_rays;
${he}
${K(s,Je)}
bool merge_nodes(ivec2 pixel, out vec3 color, out float eye_z) {
float nearest = 1e38, farthest = 0.0;
${K(s,a=>`
vec4 c${a} = texelFetch(node_colors, ivec3(pixel, ${a}), 0);
float d${a} = layer_z(pixel, ${a}), s${a} = 1.0;
if (c${a}.a > 0.0) {
nearest = min(nearest, d${a});
farthest = max(farthest, d${a});
}`)}
if (farthest == 0.0) {
vec4 skin = texelFetch(node_colors, ivec3(pixel, ${s}), 0);
color = skin.rgb;
eye_z = layer_z(pixel, ${s});
return skin.a > 0.0;
}
if (farthest > nearest * (1.0 + 0.5 * node_merge.x)) {
vec3 ray = vec3(node_rays.xy + node_rays.zw * (vec2(pixel) + 0.5), -1.0);
float accepted = 1e38;
if (c0.a > 0.0) accepted = d0;
${K(s,a=>a===0?"":`
if (c${a}.a > 0.0) {
if (d${a} < 1e12 * node_merge.y) {
vec3 p = d${a} * ray;
${K(s,t=>t===a?"":`        s${a} = min(s${a}, node_share${t}(p));
`)}
}
if (s${a} >= 0.5) accepted = min(accepted, d${a});
}`)}
if (accepted < 1e37) {
nearest = accepted;
} else {
${K(s,a=>`      s${a} = 1.0;
`)}
}
}
float limit = nearest * (1.0 + node_merge.x);
float weights = 0.0, most = -1.0;
color = vec3(0.0);
eye_z = nearest;
${K(s,a=>`
if (c${a}.a > 0.0 && d${a} <= limit) {
float weight = s${a} * (max(c${a}.a * 255.0 - 2.0, 0.0) + 0.25) * node_nearness[${a}];
if (weight > most) {
most = weight;
eye_z = d${a};
}
color += weight * c${a}.rgb;
weights += weight;
}`)}
color /= max(weights, 1e-20);
return true;
}
`}function Je(s){return`
uniform highp usampler2D node_seen${s};
float node_share${s}(vec3 p) {
vec3 seen = (node_from_eye[${s}] * vec4(p, 1.0)).xyz;
vec2 st;
int face = face_of(seen, st);
int last = textureSize(node_seen${s}, 0).x / 3 - 1;
ivec2 corner = ivec2(face % 3, face / 3) * (last + 1);
ivec2 at = ivec2(floor((0.5 * st + 0.5) * float(last + 1) - 0.5));
ivec2 a = corner + clamp(at, ivec2(0), ivec2(last)), b = corner + clamp(at + 1, ivec2(0), ivec2(last));
uint code = max(max(texelFetch(node_seen${s}, a, 0).r, texelFetch(node_seen${s}, b, 0).r),
max(texelFetch(node_seen${s}, ivec2(a.x, b.y), 0).r,
texelFetch(node_seen${s}, ivec2(b.x, a.y), 0).r));
if (code == 0u) return 1.0;
float nearest = unpackHalf2x16(code - 1u).x * node_steps[${s}];
float ahead = max(max(abs(seen.x), abs(seen.y)), abs(seen.z));
return clamp(2.0 - 2.0 * (1.0 / max(nearest * ahead, 1e-9) - 1.0) / node_merge.x, 0.0, 1.0);
}
`}var fe=`
uniform mat3 world_from_pixel;
vec4 sky_color() {
float elevation = normalize(world_from_pixel * vec3(gl_FragCoord.xy, 1.0)).y;
vec3 above = mix(vec3(0.75, 0.82, 0.90), vec3(0.25, 0.45, 0.85), sqrt(clamp(elevation, 0.0, 1.0)));
vec3 linear = mix(above, vec3(0.20, 0.19, 0.17), smoothstep(0.0, 1.0, -elevation / 0.08));
return vec4(mix(1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, 12.92 * linear,
vec3(lessThanEqual(linear, vec3(0.0031308)))), 1.0);
}
`;function Ie(s,e){return`#version 300 es
precision highp float;
precision highp int;
${Oe(s)}${e?fe:""}
uniform vec4 projection;
layout(location = 0) out vec4 out_color;
void main() {
vec3 color;
float eye_z;
if (!merge_nodes(ivec2(gl_FragCoord.xy), color, eye_z)) {
${e?`    out_color = sky_color();
    gl_FragDepth = 1.0;
    return;`:"    discard;"}
}
out_color = vec4(color, 1.0);
float z = (projection.y - projection.x * eye_z) / (projection.w - projection.z * eye_z);
gl_FragDepth = min(0.5 * z + 0.5, 1.0 - exp2(-23.0));
}
`}function q(s,e,a,t){let i=s.createProgram();if(!i)throw new Error(`${e}: the WebGL context is lost`);for(let[r,o]of[[s.VERTEX_SHADER,a],[s.FRAGMENT_SHADER,t]]){let n=s.createShader(r);if(!n)throw new Error(`${e}: the WebGL context is lost`);s.shaderSource(n,o),s.compileShader(n),s.attachShader(i,n),s.deleteShader(n)}if(s.linkProgram(i),!s.getProgramParameter(i,s.LINK_STATUS)&&!s.isContextLost()){let r=(s.getAttachedShaders(i)??[]).map(o=>s.getShaderInfoLog(o));throw new Error(`${e}: ${[s.getProgramInfoLog(i),...r].join(" ").trim()}`)}return i}function de(s,e){let a=s.indexOf(`
`)+1;return s.slice(0,a)+e.map(t=>`#define ${t} 1
`).join("")+s.slice(a)}function pe(s,...e){return q(s,"node",de(Ve,e),de(Ce,e))}function me(s,e,a){return q(s,"merge",te,Ie(e,a))}var He=`#version 300 es
precision highp float;
precision highp usampler2D;
uniform usampler2D objects;
layout(location = 0) out vec4 out_color;
void main() {
uint id = texelFetch(objects, ivec2(gl_FragCoord.xy), 0).r;
out_color = vec4(float(id & 255u), float(id >> 8u), 0.0, 255.0) / 255.0;
}
`;function ue(s){return q(s,"objects",te,He)}var Xe=`#version 300 es
precision highp float;
${fe}
layout(location = 0) out vec4 out_color;
void main() { out_color = sky_color(); }
`;function ge(s){return q(s,"sky",te.replace(`0.0,
`,`1.0,
`),Xe)}var $e=`#version 300 es
precision highp float;
layout(location = 0) in vec3 direction;
layout(location = 1) in float disparity;
uniform vec3 right, up;
out float v_disparity;
void main() {
gl_Position = vec4(dot(direction, right), dot(direction, up), 0.0, 1.0);
v_disparity = disparity;
}
`,Ye=`#version 300 es
precision highp float;
precision highp int;
in float v_disparity;
layout(location = 0) out uvec4 out_code;
void main() {
out_code = uvec4(packHalf2x16(vec2(clamp(v_disparity, 0.0, 65504.0), 0.0)) + 1u, 0u, 0u, 0u);
}
`,Qe=`#version 300 es
void main() {
gl_Position = vec4(float((gl_VertexID & 1) * 4) - 1.0, float((gl_VertexID >> 1) * 4) - 1.0, 0.0,
1.0);
}
`,Ze=`#version 300 es
precision highp float;
uniform sampler2D weights;
layout(location = 0) out vec4 out_color;
void main() {
out_color = vec4(texelFetch(weights, ivec2(gl_FragCoord.xy), 0).r);
}
`;function we(s){for(let e of[s.SCISSOR_TEST,s.BLEND,s.STENCIL_TEST,s.DEPTH_TEST,s.CULL_FACE])s.disable(e)}var H=class{constructor(e){this.gl=e;this.program=q(e,"weights",Qe,Ze),this.framebuffer=e.createFramebuffer(),this.vertices=e.createVertexArray()}write(e,a,t,i){let{gl:r}=this,o=r.createTexture();r.activeTexture(r.TEXTURE0),r.bindTexture(r.TEXTURE_2D,o),r.texParameteri(r.TEXTURE_2D,r.TEXTURE_MIN_FILTER,r.NEAREST),r.pixelStorei(r.UNPACK_ALIGNMENT,1),r.pixelStorei(r.UNPACK_ROW_LENGTH,3*t),r.texImage2D(r.TEXTURE_2D,0,r.R8,t,t,0,r.RED,r.UNSIGNED_BYTE,e,t*(a%3+3*t*Math.floor(a/3))),r.pixelStorei(r.UNPACK_ROW_LENGTH,0),r.pixelStorei(r.UNPACK_ALIGNMENT,4),r.bindFramebuffer(r.FRAMEBUFFER,this.framebuffer),r.framebufferTexture2D(r.FRAMEBUFFER,r.COLOR_ATTACHMENT0,r.TEXTURE_CUBE_MAP_POSITIVE_X+a,i,0),we(r),r.colorMask(!1,!1,!1,!0),r.viewport(0,0,t,t),r.useProgram(this.program),r.bindVertexArray(this.vertices),r.drawArrays(r.TRIANGLES,0,3),r.bindVertexArray(null),r.colorMask(!0,!0,!0,!0),r.framebufferTexture2D(r.FRAMEBUFFER,r.COLOR_ATTACHMENT0,r.TEXTURE_CUBE_MAP_POSITIVE_X+a,null,0),r.bindFramebuffer(r.FRAMEBUFFER,null),r.deleteTexture(o)}dispose(){this.gl.deleteProgram(this.program),this.gl.deleteFramebuffer(this.framebuffer),this.gl.deleteVertexArray(this.vertices)}},X=class{constructor(e){this.gl=e;this.program=q(e,"seen",$e,Ye),this.right=e.getUniformLocation(this.program,"right"),this.up=e.getUniformLocation(this.program,"up"),this.framebuffer=e.createFramebuffer()}draw(e){let{gl:a}=this,t=e.level.faceSize,i=1/t;a.bindFramebuffer(a.FRAMEBUFFER,this.framebuffer),a.framebufferTexture2D(a.FRAMEBUFFER,a.COLOR_ATTACHMENT0,a.TEXTURE_2D,e.seen,0),we(a),a.colorMask(!0,!0,!0,!0),a.clearBufferuiv(a.COLOR,0,[0,0,0,0]),a.useProgram(this.program),a.bindVertexArray(e.surfaces);for(let r=0;r<6;++r){let o=M[r];a.viewport(r%3*t,Math.floor(r/3)*t,t,t),a.uniform3f(this.right,o[3]*i,o[4]*i,o[5]*i),a.uniform3f(this.up,o[6]*i,o[7]*i,o[8]*i);let n=e.surfaceStarts[r],c=e.surfaceStarts[r+1]-n;c>0&&a.drawElements(a.TRIANGLES,3*c,a.UNSIGNED_INT,12*n)}a.bindVertexArray(null),a.framebufferTexture2D(a.FRAMEBUFFER,a.COLOR_ATTACHMENT0,a.TEXTURE_2D,null,0),a.bindFramebuffer(a.FRAMEBUFFER,null)}dispose(){this.gl.deleteProgram(this.program),this.gl.deleteFramebuffer(this.framebuffer)}};var W=4,ve=.03,ea=2,aa=1e30,ta=[],ye=34383,ra=36001,ia=37726,B=class{constructor(e){this.gl=e;this.stats={drawCalls:0,triangles:0};this.colors=null;this.depths=null;this.layers=0;this.mergeUniform=new Float32Array(2);this.nearness=new Float32Array(W);this.steps=new Float32Array(W);this.nodeFromEye=new Float32Array(16*W);this.rays=new Float32Array(4);this.seen=new Array(W).fill(null);this.surfaceObject=null;this.skinObject=null;this.showObjects=null;this.sky=null;this.pixels=new Float32Array(9);this.mergePrograms=[];this.framebuffers=[];this.objectTarget=null;this.width=0;this.height=0;this.unmix=-1;this.clip=new Float64Array(16);this.clip32=new Float32Array(16);this.scales=new Float32Array(4);this.projection=new Float32Array(4);this.corners=new Float64Array(12);this.apex=new Float64Array(3);this.visible=new Uint8Array(6);this.surface=this.nodeProgram("UNMIXES"),this.skin=this.nodeProgram("SKIN"),this.seenDrawer=new X(e),this.weightWriter=new H(e),this.noVertices=e.createVertexArray(),this.clamps=e.getExtension("EXT_depth_clamp")!==null,this.clipControl=e.getExtension("EXT_clip_control")}drawLayers(e,a,t){let{gl:i,stats:r}=this;r.drawCalls=0,r.triangles=0;let o=e.worldFromEye,n=re(e,a[0])<1e-6*Math.max(1,Math.hypot(o[12],o[13],o[14]));n&&(t=1),this.unmix=n?-1:ve,this.makeLayers(e.width,e.height,Math.max(2,t)+1),this.layers=t;let c=this.begin(e);this.setMerge(e,a,t,c);for(let b=0;b<t;++b)this.beginLayer(b),this.beginNode(e,a[b],c),i.activeTexture(i.TEXTURE1),i.bindTexture(i.TEXTURE_2D,a[b].seen),this.drawSurfaces(this.surface,a[b],b===0),t===1&&this.drawSkins(this.skin,a[b],!0);if(t>1){this.beginLayer(t);for(let b=0;b<t;++b)this.beginNode(e,a[b],c),this.drawSkins(this.skin,a[b],b===0)}this.end()}merge(e,a=!1){let{gl:t}=this;if(this.layers===0)return;let i=this.mergeFor(this.layers,a);if(t.useProgram(i.program),t.activeTexture(t.TEXTURE0),t.bindTexture(t.TEXTURE_2D_ARRAY,this.colors),t.activeTexture(t.TEXTURE1),t.bindTexture(t.TEXTURE_2D_ARRAY,this.depths),t.uniform2fv(i.merge,this.mergeUniform),this.layers>1){for(let o=0;o<this.layers;++o)t.activeTexture(t.TEXTURE2+o),t.bindTexture(t.TEXTURE_2D,this.seen[o]);t.uniform1fv(i.nearness,this.nearness,0,this.layers),t.uniform1fv(i.steps,this.steps,0,this.layers),t.uniformMatrix4fv(i.nodeFromEye,!1,this.nodeFromEye,0,16*this.layers),t.uniform4fv(i.rays,this.rays)}t.activeTexture(t.TEXTURE0);let r=e.clipFromEye;this.projection[0]=r[10],this.projection[1]=r[14],this.projection[2]=r[11],this.projection[3]=r[15],t.uniform4fv(i.projection,this.projection),a&&this.setSky(e,i.place),t.enable(t.DEPTH_TEST),t.depthFunc(t.LEQUAL),t.depthMask(!0),t.disable(t.BLEND),t.disable(t.CULL_FACE),t.bindVertexArray(this.noVertices),t.drawArrays(t.TRIANGLES,0,3),t.bindVertexArray(null),++this.stats.drawCalls,++this.stats.triangles}drawSky(e){let{gl:a}=this;if(!this.sky){let t=ge(a);this.sky={program:t,place:a.getUniformLocation(t,"world_from_pixel")}}a.useProgram(this.sky.program),this.setSky(e,this.sky.place),a.enable(a.DEPTH_TEST),a.depthFunc(a.LEQUAL),a.bindVertexArray(this.noVertices),a.drawArrays(a.TRIANGLES,0,3),a.bindVertexArray(null),++this.stats.drawCalls}drawObjects(e,a,t,i){let{gl:r}=this;this.surfaceObject??=this.nodeProgram("OBJECT"),this.skinObject??=this.nodeProgram("SKIN","OBJECT"),this.showObjects??=ue(r);let o=this.makeObjectTarget(e.width,e.height),n=this.begin(e);r.bindFramebuffer(r.FRAMEBUFFER,o.framebuffer),r.clearBufferuiv(r.COLOR,0,[0,0,0,0]),r.clear(r.DEPTH_BUFFER_BIT);for(let c=0;c<t;++c)r.activeTexture(r.TEXTURE1),r.bindTexture(r.TEXTURE_2D,a[c].objects),this.beginNode(e,a[c],n),this.drawSurfaces(this.surfaceObject,a[c],c===0),this.drawSkins(this.skinObject,a[c],c===0);this.end(),r.bindFramebuffer(r.FRAMEBUFFER,i),r.useProgram(this.showObjects),r.activeTexture(r.TEXTURE0),r.bindTexture(r.TEXTURE_2D,o.texture),r.disable(r.DEPTH_TEST),r.bindVertexArray(this.noVertices),r.drawArrays(r.TRIANGLES,0,3),r.bindVertexArray(null),r.bindTexture(r.TEXTURE_2D,null)}get bytes(){return 8*this.width*this.height*this.framebuffers.length}dispose(){let{gl:e}=this;this.dropLayers(),this.seenDrawer.dispose(),this.weightWriter.dispose();for(let a of[this.surface,this.skin,this.surfaceObject,this.skinObject])a&&e.deleteProgram(a.program);for(let a of this.mergePrograms)a&&e.deleteProgram(a.program);this.showObjects&&e.deleteProgram(this.showObjects),this.sky&&e.deleteProgram(this.sky.program),e.deleteVertexArray(this.noVertices),this.dropObjectTarget()}nodeProgram(...e){let{gl:a}=this,t=pe(a,...e);return a.useProgram(t),a.uniform1i(a.getUniformLocation(t,"faces"),0),a.uniform1i(a.getUniformLocation(t,"objects"),1),a.uniform1i(a.getUniformLocation(t,"seen"),1),{program:t,clip:a.getUniformLocation(t,"clip_from_node"),scales:a.getUniformLocation(t,"scales"),widest:a.getUniformLocation(t,"widest_skin"),unmix:a.getUniformLocation(t,"unmix")}}mergeFor(e,a){let t=2*e+(a?1:0),i=this.mergePrograms[t];if(i)return i;let{gl:r}=this,o=me(r,e,a);r.useProgram(o),r.uniform1i(r.getUniformLocation(o,"node_colors"),0),r.uniform1i(r.getUniformLocation(o,"node_depths"),1);for(let n=0;n<e;++n)r.uniform1i(r.getUniformLocation(o,`node_seen${n}`),2+n);return this.mergePrograms[t]={program:o,merge:r.getUniformLocation(o,"node_merge"),nearness:r.getUniformLocation(o,"node_nearness"),steps:r.getUniformLocation(o,"node_steps"),nodeFromEye:r.getUniformLocation(o,"node_from_eye"),rays:r.getUniformLocation(o,"node_rays"),projection:r.getUniformLocation(o,"projection"),place:r.getUniformLocation(o,"world_from_pixel")}}begin(e){let{gl:a}=this,t=e.clipFromEye,i=e.near??Math.abs(t[14]/(t[10]-1));return a.viewport(0,0,e.width,e.height),a.disable(a.SCISSOR_TEST),a.disable(a.BLEND),a.disable(a.STENCIL_TEST),a.enable(a.DEPTH_TEST),a.depthFunc(a.LEQUAL),a.depthMask(!0),a.colorMask(!0,!0,!0,!0),a.frontFace(a.CCW),a.cullFace(a.BACK),a.clearColor(0,0,0,0),a.clearDepth(1),this.clamps&&a.enable(ye),this.clipControl?.clipControlEXT(ra,ia),this.clamps?i:i/4}end(){let{gl:e}=this;this.clamps&&e.disable(ye),e.disable(e.CULL_FACE),e.bindVertexArray(null),e.activeTexture(e.TEXTURE1),e.bindTexture(e.TEXTURE_2D,null),e.activeTexture(e.TEXTURE0),e.bindTexture(e.TEXTURE_CUBE_MAP,null)}beginOther(e){this.stats.drawCalls=this.stats.triangles=0,this.makeLayers(e.width,e.height,1),this.layers=1;let a=this.begin(e);return this.setMerge(e,ta,0,a),this.beginLayer(0),a}endOther(){this.end()}setSky(e,a){let{gl:t,pixels:i}=this,r=e.worldFromEye,o=e.clipFromEye,n=2/(e.width*o[0]),c=2/(e.height*o[5]),b=(o[8]-1)/o[0],h=(o[9]-1)/o[5];for(let l=0;l<3;++l)i[l]=r[l]*n,i[3+l]=r[4+l]*c,i[6+l]=r[l]*b+r[4+l]*h-r[8+l];t.uniformMatrix3fv(a,!1,i)}beginLayer(e){let{gl:a}=this;a.bindFramebuffer(a.FRAMEBUFFER,this.framebuffers[e]),a.clear(a.COLOR_BUFFER_BIT|a.DEPTH_BUFFER_BIT)}setMerge(e,a,t,i){let{nearness:r,steps:o,nodeFromEye:n,rays:c}=this;this.mergeUniform[0]=ve,this.mergeUniform[1]=i;let b=0;for(let p=0;p<t;++p)b+=1/Math.max(1e-9,re(e,a[p]));let h=e.worldFromEye,l=e.clipFromEye;for(let p=0;p<t;++p){let d=a[p],m=d.worldFromNode,v=1/Math.max(1e-9,re(e,d))/b;r[p]=Math.max(1e-9,v*v),o[p]=d.level.mesh.disparityStep,this.seen[p]=d.seen;for(let g=0;g<4;++g)for(let w=0;w<4;++w){let A=w===3&&g===3?1:0;if(w<3)for(let E=0;E<3;++E)A+=m[4*w+E]*(h[4*g+E]-(g===3?m[12+E]:0));n[16*p+4*g+w]=A}}c[0]=(l[8]-1)/l[0],c[1]=(l[9]-1)/l[5],c[2]=2/(e.width*l[0]),c[3]=2/(e.height*l[5])}beginNode(e,a,t){let{gl:i,scales:r}=this;this.setClip(e,a),this.findVisible(e,a);for(let o=0;o<16;++o)this.clip32[o]=this.clip[o];r[0]=1/a.level.faceSize,r[1]=a.level.mesh.disparityStep,r[2]=.25/a.level.faceSize,r[3]=2*t,i.activeTexture(i.TEXTURE0),i.bindTexture(i.TEXTURE_CUBE_MAP,a.faces)}drawSurfaces(e,a,t){let{gl:i}=this;t?i.disable(i.CULL_FACE):i.enable(i.CULL_FACE),this.drawSides(e,a.surfaces,a.surfaceStarts,0),i.disable(i.CULL_FACE)}drawSkins(e,a,t){this.drawSides(e,a.skins,a.skinStarts,t?aa:ea)}drawSides(e,a,t,i){let{gl:r,visible:o,stats:n}=this;r.useProgram(e.program),r.uniformMatrix4fv(e.clip,!1,this.clip32),r.uniform4fv(e.scales,this.scales),e.widest&&r.uniform1f(e.widest,i),e.unmix&&r.uniform1f(e.unmix,this.unmix),r.bindVertexArray(a);for(let c=0;c<6;++c){if(!o[c])continue;let b=t[c];for(;c+1<6&&o[c+1];)++c;let h=t[c+1]-b;h!==0&&(r.drawElements(r.TRIANGLES,3*h,r.UNSIGNED_INT,12*b),++n.drawCalls,n.triangles+=h)}}setClip(e,a){let t=a.worldFromNode,i=e.worldFromEye,r=e.clipFromEye,o=this.clip;for(let c=0;c<4;++c){let b=t[4*c]-(c===3?i[12]:0),h=t[4*c+1]-(c===3?i[13]:0),l=t[4*c+2]-(c===3?i[14]:0),p=i[0]*b+i[1]*h+i[2]*l,d=i[4]*b+i[5]*h+i[6]*l,m=i[8]*b+i[9]*h+i[10]*l,v=c===3?1:0;for(let g=0;g<4;++g)o[4*c+g]=r[g]*p+r[4+g]*d+r[8+g]*m+r[12+g]*v}let n=-r[11]||1;if(n!==1)for(let c=0;c<16;++c)o[c]/=n}findVisible(e,a){let{corners:t,apex:i,visible:r,clip:o}=this,n=a.worldFromNode,c=e.worldFromEye,b=e.clipFromEye,h=(l,p,d,m,v)=>{m[v]=n[0]*l+n[1]*p+n[2]*d,m[v+1]=n[4]*l+n[5]*p+n[6]*d,m[v+2]=n[8]*l+n[9]*p+n[10]*d};h(c[12]-n[12],c[13]-n[13],c[14]-n[14],i,0);for(let l=0;l<4;++l){let p=((l&1?1:-1)+b[8])/b[0],d=((l&2?1:-1)+b[9])/b[5];h(c[0]*p+c[4]*d-c[8],c[1]*p+c[5]*d-c[9],c[2]*p+c[6]*d-c[10],t,3*l)}for(let l=0;l<6;++l){r[l]=0;let p=a.reaches[2*l],d=a.reaches[2*l+1];if(!(d>=p))continue;let m=M[l],v=31;for(let w=0;w<8;++w){let A=w&1?1:-1,E=w&2?1:-1,j=w&4?d:p,L=m[0]+A*m[3]+E*m[6],y=m[1]+A*m[4]+E*m[7],f=m[2]+A*m[5]+E*m[8],u=o[0]*L+o[4]*y+o[8]*f+o[12]*j,x=o[1]*L+o[5]*y+o[9]*f+o[13]*j,F=o[3]*L+o[7]*y+o[11]*f+o[15]*j;v&=(u<-F?1:0)|(u>F?2:0)|(x<-F?4:0)|(x>F?8:0)|(F<0?16:0)}if(v)continue;let g=!1;for(let w=0;w<4;++w){let A=w&1?-1:1,E=w<2?3:6,j=m[0]+A*m[E],L=m[1]+A*m[E+1],y=m[2]+A*m[E+2],f=j*i[0]+L*i[1]+y*i[2]<0;for(let u=0;u<4;++u)f=f&&j*t[3*u]+L*t[3*u+1]+y*t[3*u+2]<0;g=g||f}g||(r[l]=1)}}makeLayers(e,a,t){if(e===this.width&&a===this.height&&t<=this.framebuffers.length)return;let{gl:i}=this;this.dropLayers();let r=n=>{let c=i.createTexture();i.bindTexture(i.TEXTURE_2D_ARRAY,c),i.texStorage3D(i.TEXTURE_2D_ARRAY,1,n,e,a,t);for(let b of[i.TEXTURE_MIN_FILTER,i.TEXTURE_MAG_FILTER])i.texParameteri(i.TEXTURE_2D_ARRAY,b,i.NEAREST);return i.bindTexture(i.TEXTURE_2D_ARRAY,null),c};this.colors=r(i.RGBA8),this.depths=r(i.DEPTH_COMPONENT32F);for(let n=0;n<t;++n){let c=i.createFramebuffer();i.bindFramebuffer(i.FRAMEBUFFER,c),i.framebufferTextureLayer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0,this.colors,0,n),i.framebufferTextureLayer(i.FRAMEBUFFER,i.DEPTH_ATTACHMENT,this.depths,0,n),c&&this.framebuffers.push(c)}if(i.checkFramebufferStatus(i.FRAMEBUFFER)!==i.FRAMEBUFFER_COMPLETE&&!i.isContextLost())throw this.dropLayers(),new _("WebGL",`there is no memory for frames of ${e} x ${a}`);this.width=e,this.height=a}dropLayers(){let{gl:e}=this;for(let a of this.framebuffers)e.deleteFramebuffer(a);this.framebuffers=[],e.deleteTexture(this.colors),e.deleteTexture(this.depths),this.colors=this.depths=null,this.width=this.height=this.layers=0}makeObjectTarget(e,a){let{gl:t}=this;this.dropObjectTarget();let i=t.createTexture();t.bindTexture(t.TEXTURE_2D,i),t.texStorage2D(t.TEXTURE_2D,1,t.RGBA16UI,e,a);for(let n of[t.TEXTURE_MIN_FILTER,t.TEXTURE_MAG_FILTER])t.texParameteri(t.TEXTURE_2D,n,t.NEAREST);let r=t.createRenderbuffer();t.bindRenderbuffer(t.RENDERBUFFER,r),t.renderbufferStorage(t.RENDERBUFFER,t.DEPTH_COMPONENT32F,e,a);let o=t.createFramebuffer();return t.bindFramebuffer(t.FRAMEBUFFER,o),t.framebufferTexture2D(t.FRAMEBUFFER,t.COLOR_ATTACHMENT0,t.TEXTURE_2D,i,0),t.framebufferRenderbuffer(t.FRAMEBUFFER,t.DEPTH_ATTACHMENT,t.RENDERBUFFER,r),this.objectTarget={framebuffer:o,texture:i,depth:r}}dropObjectTarget(){let{gl:e,objectTarget:a}=this;a&&(e.deleteFramebuffer(a.framebuffer),e.deleteTexture(a.texture),e.deleteRenderbuffer(a.depth),this.objectTarget=null)}};function re(s,e){let a=s.worldFromEye,t=e.worldFromNode;return Math.hypot(a[12]-t[12],a[13]-t[13],a[14]-t[14])}var ie=6,oe=2;function sa(s,e,a){return 6*s.faceSize*s.faceSize*(ie+(a?oe:0))+e.surfaceVertices.length+e.skinVertices.length+e.surfaceIndices.byteLength+e.skinIndices.byteLength}function ke(s){let e=new Uint32Array(7);for(let a=0;a<6;++a)e[a+1]=e[a]+s[a];return e}function na(s,e){let a=s.createTexture();s.bindTexture(s.TEXTURE_CUBE_MAP,a),s.texStorage2D(s.TEXTURE_CUBE_MAP,1,s.RGBA8,e,e);for(let t of[s.TEXTURE_MIN_FILTER,s.TEXTURE_MAG_FILTER])s.texParameteri(s.TEXTURE_CUBE_MAP,t,s.LINEAR);return s.bindTexture(s.TEXTURE_CUBE_MAP,null),a}function Ee(s,e,a){let t=s.createTexture();s.bindTexture(s.TEXTURE_2D,t),s.texStorage2D(s.TEXTURE_2D,1,s.R16UI,3*e,2*e),a&&(s.pixelStorei(s.UNPACK_ALIGNMENT,2),s.texSubImage2D(s.TEXTURE_2D,0,0,0,3*e,2*e,s.RED_INTEGER,s.UNSIGNED_SHORT,a),s.pixelStorei(s.UNPACK_ALIGNMENT,4));for(let i of[s.TEXTURE_MIN_FILTER,s.TEXTURE_MAG_FILTER])s.texParameteri(s.TEXTURE_2D,i,s.NEAREST);return s.bindTexture(s.TEXTURE_2D,null),t}function _e(s,e,a,t,i,r){let o=[],n=(d,m)=>{let v=s.createBuffer();s.bindBuffer(d,v),s.bufferData(d,m,s.STATIC_DRAW),v&&o.push(v)},c=(d,m,v)=>{let g=s.createVertexArray();return s.bindVertexArray(g),n(s.ARRAY_BUFFER,d),n(s.ELEMENT_ARRAY_BUFFER,m),s.enableVertexAttribArray(0),s.vertexAttribPointer(0,3,s.SHORT,!1,v,0),s.enableVertexAttribArray(1),s.vertexAttribPointer(1,1,s.UNSIGNED_SHORT,!1,v,6),v===16&&(s.enableVertexAttribArray(2),s.vertexAttribPointer(2,3,s.SHORT,!1,v,8),s.enableVertexAttribArray(3),s.vertexAttribPointer(3,1,s.UNSIGNED_SHORT,!1,v,14)),s.bindVertexArray(null),g},b=c(t.surfaceVertices,t.surfaceIndices,8),h=c(t.skinVertices,t.skinIndices,16),l=ke(a.mesh.surfaces),p=ke(a.mesh.skins);return{worldFromNode:e,level:a,faces:na(s,a.faceSize),seen:Ee(s,a.faceSize,null),objects:r?Ee(s,a.faceSize,r):null,surfaces:b,skins:h,buffers:o,surfaceStarts:l,skinStarts:p,reaches:t.reaches,triangles:l[6]+p[6],bytes:sa(a,t,r!==null),uploaded:0,weightSheet:i}}function Ae(s,e,a,t){let i=s.TEXTURE_CUBE_MAP_POSITIVE_X+e.uploaded;s.pixelStorei(s.UNPACK_FLIP_Y_WEBGL,!1),s.pixelStorei(s.UNPACK_PREMULTIPLY_ALPHA_WEBGL,!1),s.pixelStorei(s.UNPACK_COLORSPACE_CONVERSION_WEBGL,s.NONE),s.bindTexture(s.TEXTURE_CUBE_MAP,e.faces),s.texSubImage2D(i,0,0,0,s.RGBA,s.UNSIGNED_BYTE,a),s.pixelStorei(s.UNPACK_COLORSPACE_CONVERSION_WEBGL,s.BROWSER_DEFAULT_WEBGL),s.bindTexture(s.TEXTURE_CUBE_MAP,null),e.weightSheet&&t.write(e.weightSheet,e.uploaded,e.level.faceSize,e.faces),++e.uploaded===6&&(e.weightSheet=null)}function $(s,e){for(let a of[e.faces,e.seen,e.objects])s.deleteTexture(a);s.deleteVertexArray(e.surfaces),s.deleteVertexArray(e.skins);for(let a of e.buffers)s.deleteBuffer(a)}var Fe=1<<30,ca=1<<26;function Re(s,e){let a=y=>{throw new _(e,y)},t=(y,f)=>typeof y=="object"&&y!==null&&!Array.isArray(y)?y:a(`${f} is no object`),i=(y,f)=>Array.isArray(y)?y:a(`${f} is no list`),r=(y,f,u=-1/0,x=1/0)=>typeof y=="number"&&Number.isFinite(y)&&y>=u&&y<=x?y:a(`${f} is no number${u>-1/0?` from ${u} to ${x}`:""}`),o=(y,f,u=ca)=>{let x=r(y,f,0,u);return Number.isInteger(x)?x:a(`${f} is no whole number`)},n=(y,f)=>{let u=i(y,f);return u.length!==3&&a(`${f} has not three numbers`),[r(u[0],f),r(u[1],f),r(u[2],f)]},c=(y,f)=>{let u=t(y,f),x=u.file;return typeof x!="string"||!/^[\w-]+(\/[\w-]+)*\.\w+$/.test(x)?a(`${f} names no file beside the manifest`):{name:x,bytes:o(u.bytes,`${f}.bytes`,Fe)}},b=(y,f)=>{let u=t(y,f);return{bytes:o(u.bytes,`${f}.bytes`,Fe),count:o(u.count,`${f}.count`)}},h=(y,f,u)=>{let x=i(y,f).map(F=>o(F,f));return(x.length!==6||3*x.reduce((F,S)=>F+S,0)!==u)&&a(`${f} is not the triangles of six sides`),x},l=(y,f)=>{let u=t(y,f),x={...c(u,f),surfaceVertices:b(u.surface_vertices,`${f}.surface_vertices`),surfaceIndices:b(u.surface_indices,`${f}.surface_indices`),skinVertices:b(u.skin_vertices,`${f}.skin_vertices`),skinIndices:b(u.skin_indices,`${f}.skin_indices`),disparityStep:r(u.disparity_step,`${f}.disparity_step`,0,1e30)};return x.surfaceVertices.bytes+x.surfaceIndices.bytes+x.skinVertices.bytes+x.skinIndices.bytes!==x.bytes&&a(`${f}.bytes is not the sum of its streams`),{...x,surfaces:h(u.surfaces,`${f}.surfaces`,x.surfaceIndices.count),skins:h(u.skins,`${f}.skins`,x.skinIndices.count)}},p=(y,f)=>({...c(y,f),steps:Math.max(1,o(t(y,f).steps,`${f}.steps`,65535))}),d=(y,f)=>{let u=i(y,f).map(x=>r(x,f));return u.length!==16&&a(`${f} has not 16 numbers`),Float64Array.from(u)},m=(y,f,u)=>{let x=t(y,f),F=t(x.depths,`${f}.depths`),[S,k,R,T]=i(x.window,`${f}.window`).map(z=>r(z,`${f}.window`,-1e9,1e9));k>S&&T>R||a(`${f}.window is empty`);let[G,P]=i(x.size,`${f}.size`).map(z=>o(z,`${f}.size`,8192));return G>0&&P>0||a(`${f}.size is empty`),{worldFromEye:d(x.world_from_eye,`${f}.world_from_eye`),left:S,right:k,bottom:R,top:T,width:G,height:P,du:(k-S)/G,dv:(T-R)/P,zNear:r(x.z_near,`${f}.z_near`,1e-12,1e12),zFar:r(x.z_far,`${f}.z_far`,1e-12,1e12),colors:c(x.colors,`${f}.colors`),depths:{...c(F,`${f}.depths`),least:r(F.least,`${f}.depths.least`,0,1e30),step:r(F.step,`${f}.depths.step`,0,1e30)},backPerspective:x.back_perspective===!0,complete:x.complete===!0,direction:u?n(x.direction,`${f}.direction`):[0,0,0],planeZ:u?1:r(x.plane_z,`${f}.plane_z`,1e-12,1e12)}},v=y=>{let{drawn:f}=y;if(f!=="surfaces"&&f!=="nailboards")return a(`pictures.drawn is ${JSON.stringify(f)}, which this viewer cannot draw`);let u=f==="surfaces",x=i(y.bounds,"pictures.bounds"),F=n(x[0],"pictures.bounds"),S=n(x[1],"pictures.bounds"),k=P=>.5*(F[P]+S[P]),R=u?t(y.links,"pictures.links"):{},T=P=>u?r(R[P],`pictures.links.${P}`,0,1e9):0,G=i(y.list,"pictures.list").map((P,z)=>m(P,`pictures.list[${z}]`,u));return G.length===0&&a("pictures.list is empty"),{drawn:f,low:F,high:S,center:[k(0),k(1),k(2)],slack:5e-5*Math.hypot(S[0]-F[0],S[1]-F[1],S[2]-F[2])+1e-9,handover:u?r(y.handover,"pictures.handover",0,7):0,links:{gentle:T("gentle"),steepest:T("steepest"),growth:T("growth")},list:G}},g;try{g=JSON.parse(s)}catch{a("is not JSON: perhaps it is cut short, or a page that says that there is no such file")}let w=t(g,"the manifest");w.schema!=="rilievo-walk-1"&&a(`its schema is ${JSON.stringify(w.schema)??"missing"}, not "rilievo-walk-1"`);let A=t(w.start,"start"),E=w.pictures===void 0?null:v(t(w.pictures,"pictures")),j=E?null:t(w.sketches,"sketches"),L=(E?[]:i(w.nodes,"nodes")).map((y,f)=>{let u=`nodes[${f}]`,x=t(y,u),F=d(x.world_from_node,`${u}.world_from_node`),S=i(x.levels,`${u}.levels`).map((k,R)=>{let T=t(k,`${u}.levels[${R}]`);return{faceSize:Math.max(1,o(T.face_size,`${u}.levels[${R}].face_size`,4096)),colors:c(T.colors,`${u}.levels[${R}].colors`),mesh:l(T.mesh,`${u}.levels[${R}].mesh`),weights:p(T.weights,`${u}.levels[${R}].weights`),objects:T.objects===void 0?null:c(T.objects,`${u}.objects`),errorPx:r(T.error_px,`${u}.levels[${R}].error_px`),reach:r(T.reach,`${u}.levels[${R}].reach`)}});return S.length===0&&a(`${u} has no level`),{worldFromNode:F,eye:[F[12],F[13],F[14]],levels:S}});return!E&&L.length===0&&a("it has no node"),{name:typeof w.name=="string"?w.name:"",up:n(w.up,"up"),start:{eye:n(A.eye,"start.eye"),target:n(A.target,"start.target"),verticalFov:r(A.vertical_fov,"start.vertical_fov",.01,3),zNear:r(A.z_near,"start.z_near",1e-9,1e9),zFar:r(A.z_far,"start.z_far",1e-9,1e12)},nodes:L,pictures:E,sketches:j&&{...c(j,"sketches"),size:Math.max(1,o(j.size,"sketches.size",256)),near:r(j.near,"sketches.near",1e-30,1e30),far:r(j.far,"sketches.far",1e-30,1e30)}}}var Y=class{constructor(e){let a=new URL(e,document.baseURI);a.pathname.endsWith(".json")||(a.pathname.endsWith("/")||(a.pathname+="/"),a.pathname+="walk.json"),this.base=a.href}async manifest(e){let t=await(await this.get("walk.json",this.base,e,"no-cache")).text().catch(i=>{throw U(i,"walk.json")});return Re(t,"walk.json")}async file(e,a){let t=new URL(e.name,this.base).href;for(let i of["default","reload"]){let o=await(await this.get(e.name,t,a,i)).arrayBuffer().catch(()=>null);if(a.aborted)throw new _(e.name,"is no longer wanted");if(o&&o.byteLength===e.bytes)return o;if(i==="reload")throw new _(e.name,o?`has ${o.byteLength} bytes instead of ${e.bytes}`:"the connection was lost before its end")}throw new _(e.name,"cannot be read")}close(){}async get(e,a,t,i){let r;try{r=await fetch(a,{signal:t,cache:i})}catch(o){if(t.aborted)throw new _(e,"is no longer wanted");let n=new URL(a).protocol==="file:";throw new _(e,n?"this browser does not let a page read files beside it: serve the folder, for example by: python3 -m http.server -d FOLDER":`cannot be loaded (${o instanceof Error?o.message:o})`)}if(!r.ok)throw new _(e,r.status===404?"is missing on the server":`the server answers ${r.status}`);return r}};var Te=`#version 300 es
precision highp float;
layout(location = 0) in vec4 eye_layer;
layout(location = 1) in vec4 corner_plane;
layout(location = 2) in vec4 right_width;
layout(location = 3) in vec4 down_height;
layout(location = 4) in vec4 depths;
uniform mat4 clip_from_local;
uniform vec4 forward_near;
out vec2 v_uv;
out float v_towards;
flat out vec4 v_depths;
flat out vec4 v_size_layer_eye;
flat out float v_plane;
void main() {
vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
vec3 p = corner_plane.xyz + corner.x * right_width.xyz + corner.y * down_height.xyz;
gl_Position = clip_from_local * vec4(eye_layer.xyz + p, 1.0);
gl_Position.z = 0.0;
v_uv = corner * vec2(right_width.w, down_height.w);
v_towards = dot(forward_near.xyz, p);
v_depths = depths;
v_size_layer_eye = vec4(right_width.w, down_height.w, eye_layer.w,
dot(forward_near.xyz, eye_layer.xyz));
v_plane = corner_plane.w;
}
`,je=`#version 300 es
precision highp float;
precision highp int;
precision highp sampler2DArray;
precision highp usampler2DArray;
in vec2 v_uv;
in float v_towards;
flat in vec4 v_depths;
flat in vec4 v_size_layer_eye;
flat in float v_plane;
uniform vec4 forward_near;
uniform sampler2DArray color_texture;
uniform usampler2DArray code_texture;
layout(location = 0) out vec4 out_color;
void main() {
vec2 uv = clamp(v_uv, vec2(0.5), v_size_layer_eye.xy - 0.5);
uint code = texelFetch(code_texture, ivec3(uv, v_size_layer_eye.z), 0).r;
vec4 color = texture(color_texture, vec3(uv * v_depths.zw, v_size_layer_eye.z));
if (code == 0u || color.a < 0.5) discard;
float q = v_depths.x + float(code - 1u) * v_depths.y;
float eye_z = v_size_layer_eye.w + v_towards / (q * v_plane);
if (eye_z <= 0.0) discard;
gl_FragDepth = clamp(1.0 - forward_near.w / eye_z, 0.0, 1.0);
out_color = vec4(color.rgb / color.a, 1.0);
}
`;function V(s,e){let a=[],t=0,i=4;for(let r=0;r<4;++r,i*=4)a.push(t),t+=Math.ceil(s/i);return{columns:t,rows:Math.ceil(e/4),levelAt:a}}var ba=new Float32Array(1),Ba=new Uint32Array(ba.buffer);var D=6,C=8,Pe=`#version 300 es
precision highp float;
uniform mat4 clip_from_local;
uniform vec3 box_min, box_max;
out vec3 v_ray;
void main() {
const int kStrip[14] = int[](6, 7, 4, 5, 1, 7, 3, 6, 2, 4, 0, 1, 2, 3);
int c = kStrip[gl_VertexID];
v_ray = mix(box_min, box_max, vec3(c >> 2, c >> 1 & 1, c & 1));
gl_Position = clip_from_local * vec4(v_ray, 1.0);
gl_Position.z = 0.0;
}
`,Se=`#version 300 es
precision highp float;
precision highp int;
precision highp sampler2DArray;
precision highp usampler2DArray;
#define BLOCK_BITS ${Math.log2(4)}
#define FACTOR_BITS ${Math.log2(4)}
#define BLOCK ${4}
#define LEVELS ${4}
#define PATCH_GAP 0.25
in vec3 v_ray;
uniform vec3 box_min, box_max;
uniform vec4 view_data[${D*C}];
uniform float view_weights[${D}];
uniform float view_complete[${D}];
uniform ivec2 view_counts;
uniform vec4 forward_near;
uniform int level_at[LEVELS];
uniform sampler2DArray color_texture;
uniform usampler2DArray code_texture;
uniform usampler2DArray slope_texture;
uniform usampler2DArray links_texture;
uniform sampler2DArray cell_texture;
layout(location = 0) out vec4 out_color;
struct View { vec4 u_row, v_row, w_row, apex, base, du, dv, depths; };
View view_at(int i) {
int k = ${C} * i;
return View(view_data[k], view_data[k + 1], view_data[k + 2], view_data[k + 3], view_data[k + 4],
view_data[k + 5], view_data[k + 6], view_data[k + 7]);
}
struct March { bool hit, behind, outline; float s; ivec2 texel; };
float q_of(vec4 depths, ivec3 texel) {
uint code = texelFetch(code_texture, texel, 0).r;
return code == 0u ? 0.0 : depths.z + float(code - 1u) * depths.w;
}
bool frustum_segment(View view, vec3 ray, inout vec2 t, out vec3 from, out vec3 to) {
vec3 c = vec3(view.u_row.w, view.v_row.w, view.w_row.w);
vec3 d = vec3(dot(view.u_row.xyz, ray), dot(view.v_row.xyz, ray), dot(view.w_row.xyz, ray));
vec3 p = c + t.x * d, q = c + t.y * d;
vec2 size = vec2(view.du.w, view.dv.w);
float at_p[6] = float[](p.z - view.depths.x, view.depths.y - p.z, p.x, p.y,
size.x * p.z - p.x, size.y * p.z - p.y);
float at_q[6] = float[](q.z - view.depths.x, view.depths.y - q.z, q.x, q.y,
size.x * q.z - q.x, size.y * q.z - q.y);
float begin = 0.0, end = 1.0;
for (int i = 0; i < 6; ++i) {
if (at_p[i] < 0.0 && at_q[i] < 0.0) end = -1.0;
float s = at_p[i] / (at_p[i] - at_q[i]);
if (at_p[i] < 0.0) begin = max(begin, s);
else if (at_q[i] < 0.0) end = min(end, s);
}
t = mix(t.xx, t.yy, vec2(begin, end));
vec3 a = mix(p, q, begin), b = mix(p, q, end);
from = vec3(a.xy, 1.0) / a.z;
to = vec3(b.xy, 1.0) / b.z;
return begin < end;
}
vec4 slope_of(ivec3 texel) {
uvec2 halves = texelFetch(slope_texture, texel, 0).rg;
return vec4(unpackHalf2x16(halves.x), unpackHalf2x16(halves.y));
}
float side_of(float sigma, vec3 p, ivec2 texel, float q, vec4 slope) {
if (q == 0.0) return 1.0;
vec2 d = p.xy - (vec2(texel) + 0.5);
vec2 s = mix(slope.zw, slope.xy, greaterThanEqual(d, vec2(0.0)));
return sigma * (p.z - q - dot(abs(d), s));
}
vec2 exits(ivec2 low, int side, vec2 from, vec2 inverse, vec2 ahead) {
return (vec2(low) + ahead * float(side) - from) * inverse;
}
March march_view(View view, vec3 from, vec3 to) {
March march = March(false, false, false, 0.0, ivec2(0));
float sigma = view.apex.w;
int layer = int(view.base.w);
ivec2 size = ivec2(view.du.w, view.dv.w);
vec3 delta = to - from;
vec2 inverse = 1.0 / mix(delta.xy, vec2(1e-12), lessThan(abs(delta.xy), vec2(1e-12)));
vec2 ahead = step(vec2(0.0), inverse);
ivec2 forward = ivec2(ahead) * 2 - 1;
ivec2 texel = clamp(ivec2(floor(from.xy)), ivec2(0), size - 1), moved = ivec2(0);
float t = 0.0, before = 1.0;
float leave = 0.0, enters = 0.0;
int level = LEVELS - 1;
bool done = false;
int steps = 0;
do {
bool near = false;
do {
int side = BLOCK << (level * FACTOR_BITS);
ivec2 at = texel >> (BLOCK_BITS + level * FACTOR_BITS), low = at * side;
vec2 cell = texelFetch(cell_texture, ivec3(at.x + level_at[level], at.y, layer), 0).rg;
vec2 ends = exits(low, side, from.xy, inverse, ahead);
float end = min(min(ends.x, ends.y), 1.0);
vec2 z = sigma * (from.z + delta.z * vec2(t, end));
bool in_front = min(z.x, z.y) > cell.x;
bool behind = before <= 0.0 && max(z.x, z.y) < sigma * abs(cell.y) &&
(cell.y > 0.0 || march.outline);
if (in_front || behind) {
bool across = ends.x <= ends.y;
ivec2 inside = clamp(ivec2(floor(from.xy + delta.xy * end)), low, low + (side - 1));
texel = across ? ivec2(low.x + (forward.x > 0 ? side : -1), inside.y)
: ivec2(inside.x, low.y + (forward.y > 0 ? side : -1));
moved = across ? ivec2(forward.x, 0) : ivec2(0, forward.y);
t = end;
before = in_front ? 1.0 : -1.0;
done = end >= 1.0 || any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, size));
int coarser = BLOCK_BITS + (level + 1) * FACTOR_BITS;
if (level + 1 < LEVELS && (texel >> coarser) != (low >> coarser)) ++level;
} else if (level > 0) {
--level;
} else {
near = true;
}
} while (!near && !done);
if (done) break;
ivec2 block = texel >> BLOCK_BITS;
bool edge = false;
do {
float q = q_of(view.depths, ivec3(texel, layer));
vec4 slope = slope_of(ivec3(texel, layer));
enters = side_of(sigma, from + delta * t, texel, q, slope);
edge = before > 0.0 && enters <= 0.0;
vec2 ends = exits(texel, 1, from.xy, inverse, ahead);
leave = min(min(ends.x, ends.y), 1.0);
float leaves = side_of(sigma, from + delta * leave, texel, q, slope);
march.hit = enters > 0.0 && leaves <= 0.0;
done = march.hit || (!edge && leave >= 1.0);
if (!edge && !done) {
moved = ends.x <= ends.y ? ivec2(forward.x, 0) : ivec2(0, forward.y);
texel += moved;
t = leave;
before = leaves;
done = any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, size));
}
} while (!done && !edge && (texel >> BLOCK_BITS) == block);
if (edge) {
ivec3 beyond = ivec3(texel - moved, layer);
int link = moved.x != 0 ? (moved.x > 0 ? 0 : 4) : (moved.y > 0 ? 2 : 6);
bool hole = moved == ivec2(0) || q_of(view.depths, beyond) == 0.0;
bool linked = !hole && (texelFetch(links_texture, beyond, 0).r >> link & 1u) != 0u;
if (linked) {
float q = q_of(view.depths, beyond);
float passed = side_of(sigma, from + delta * t, beyond.xy, q, slope_of(beyond));
linked = passed - enters <= PATCH_GAP * q * min(length(view.du.xyz), length(view.dv.xyz));
}
march.hit = linked;
march.s = t;
march.texel = linked ? texel : beyond.xy;
march.behind = march.behind || !linked;
march.outline = march.outline || hole;
done = linked;
leave = t;
before = -1.0;
}
if ((texel >> (BLOCK_BITS + FACTOR_BITS)) != (block >> FACTOR_BITS)) level = min(1, LEVELS - 1);
} while (!done && ++steps < 16384);
if (march.hit && leave > t) {
float q = q_of(view.depths, ivec3(texel, layer));
vec4 slope = slope_of(ivec3(texel, layer));
vec2 middle = clamp((vec2(texel) + 0.5 - from.xy) * inverse, t, leave);
vec4 at = vec4(t, min(middle.x, middle.y), max(middle.x, middle.y), leave);
vec4 s = vec4(enters, side_of(sigma, from + delta * at.y, texel, q, slope),
side_of(sigma, from + delta * at.z, texel, q, slope),
side_of(sigma, from + delta * at.w, texel, q, slope));
vec4 piece = s.y <= 0.0 ? vec4(at.xy, s.xy)
: s.z <= 0.0 ? vec4(at.yz, s.yz) : vec4(at.zw, s.zw);
march.s = piece.x + (piece.y - piece.x) * clamp(piece.z / (piece.z - piece.w), 0.0, 1.0);
march.texel = texel;
}
return march;
}
vec4 color_at(int layer, March march, vec2 at) {
vec2 offset = at - (vec2(march.texel) + 0.5), f = min(abs(offset), 0.5);
ivec2 s = ivec2(offset.x >= 0.0 ? 1 : -1, offset.y >= 0.0 ? 1 : -1);
uint links = texelFetch(links_texture, ivec3(march.texel, layer), 0).r;
int x = s.x > 0 ? 0 : 4, y = s.y > 0 ? 2 : 6;
int xy = s.x > 0 ? (s.y > 0 ? 1 : 7) : (s.y > 0 ? 3 : 5);
float wx = (links >> x & 1u) != 0u ? f.x : 0.0;
float wy = (links >> y & 1u) != 0u ? f.y : 0.0;
float wxy = (links >> xy & 1u) != 0u ? wx * wy : 0.0;
wx -= wxy;
wy -= wxy;
vec4 sum = (1.0 - wx - wy - wxy) * texelFetch(color_texture, ivec3(march.texel, layer), 0);
if (wx > 0.0) sum += wx * texelFetch(color_texture, ivec3(march.texel + ivec2(s.x, 0), layer), 0);
if (wy > 0.0) sum += wy * texelFetch(color_texture, ivec3(march.texel + ivec2(0, s.y), layer), 0);
if (wxy > 0.0) sum += wxy * texelFetch(color_texture, ivec3(march.texel + s, layer), 0);
return sum;
}
void main() {
vec3 a = box_min / v_ray, b = box_max / v_ray;
vec3 lo = min(a, b);
vec2 t = vec2(max(max(max(lo.x, lo.y), lo.z), 1e-6), 1.0);
float speed = dot(forward_near.xyz, v_ray);
vec4 blended = vec4(0.0), doubtful_color = vec4(0.0);
float surface = 0.0, nothing = 0.0, heaviest = 0.0;
float depth = 1e38, doubtful_depth = 1e38;
bool skin = false;
int inside = 0;
for (int i = 0; i < view_counts.x; ++i) {
bool weighty = i < view_counts.y;
if (!weighty && surface + nothing > 0.0) break;
float weight = weighty ? view_weights[i] : 1.0;
View view = view_at(i);
vec3 from, to;
vec2 stretch = t;
March march = March(false, false, false, 0.0, ivec2(0));
if (frustum_segment(view, v_ray, stretch, from, to)) march = march_view(view, from, to);
if (!march.hit) {
if (!march.behind) nothing += weight * view_complete[i];
if (march.behind) inside += march.outline ? -1 : 1;
if (!march.behind || march.outline) continue;
if (doubtful_depth < 1e37 || skin) continue;
}
int layer = int(view.base.w);
float along = mix(stretch.x * from.z, stretch.y * to.z, march.s) / mix(from.z, to.z, march.s);
float z = along * speed;
vec4 c = color_at(layer, march, mix(from.xy, to.xy, march.s));
if (!march.hit || skin || z < doubtful_depth) {
doubtful_depth = z;
doubtful_color = c;
skin = !march.hit;
}
if (!march.hit || march.behind) continue;
surface += weight;
blended += weight * c;
if (weight > heaviest) {
heaviest = weight;
depth = z;
}
}
if (skin && (inside <= 0 || view_counts.x == 1)) doubtful_depth = 1e38;
if (nothing > surface) discard;
if (surface == 0.0) {
depth = doubtful_depth;
blended = doubtful_color;
surface = 1.0;
}
if (depth > 1e37) discard;
gl_FragDepth = clamp(1.0 - forward_near.w / depth, 0.0, 1.0);
blended /= surface;
out_color = vec4(blended.rgb / max(blended.a, 1e-3), 1.0);
}
`;var Ge=6,da=Ge+8+1+1,se=["color","code","slope","links","cell"],ha=["clip_from_local","box_min","box_max","view_data","view_weights","view_complete","view_counts","forward_near"],Q=class{constructor(e,a,t,i){this.gl=e;this.entry=a;this.decoder=t;this.host=i;this.stats={drawCalls:0,triangles:0,there:0,drawn:0};this.textures={};this.instances=null;this.viewData=new Float32Array(4*C*D);this.weights=new Float32Array(D);this.complete=new Float32Array(D);this.shown=new Int32Array(D);this.clip=new Float32Array(16);this.frame=0;this.disposed=!1;let{list:r}=a;this.surfaces=a.drawn==="surfaces",this.width=Math.max(...r.map(n=>n.width)),this.height=Math.max(...r.map(n=>n.height));let o=this.width*this.height*(this.surfaces?da:Ge);if(this.layers=Math.min(r.length,e.getParameter(e.MAX_ARRAY_TEXTURE_LAYERS),Math.max(D,Math.floor(i.budget/o))),this.bytes=this.layers*o,this.slots=r.map(()=>({layer:-1,coming:!1,failed:!1,lastUsed:0,key:0,next:null})),this.order=Uint32Array.from(r,(n,c)=>c),this.boardData=new Float32Array(this.surfaces?0:20*this.layers),this.makeTextures(),this.vertices=e.createVertexArray(),this.surfaces){this.program=this.link("views",Pe,Se);let n=V(this.width,this.height).levelAt;e.uniform1iv(e.getUniformLocation(this.program.program,"level_at"),n)}else{this.program=this.link("boards",Te,je),this.instances=e.createBuffer(),e.bindVertexArray(this.vertices),e.bindBuffer(e.ARRAY_BUFFER,this.instances),e.bufferData(e.ARRAY_BUFFER,this.boardData.byteLength,e.DYNAMIC_DRAW);for(let n=0;n<20/4;++n)e.enableVertexAttribArray(n),e.vertexAttribPointer(n,4,e.FLOAT,!1,80,16*n),e.vertexAttribDivisor(n,1);e.bindVertexArray(null)}}update(e,a,t){++this.frame,this.sort(e,a,t),this.upload();let i=0;for(let r of this.slots)(r.coming||r.next)&&++i;for(let r=0;r<this.layers&&i<2;++r){let o=this.order[r],n=this.slots[o];n.layer>=0||n.coming||n.failed||n.next||(n.coming=!0,++i,this.load(o))}}get settled(){let e=this.surfaces?Math.min(D,this.slots.length):this.layers;for(let a=0;a<e;++a){let t=this.slots[this.order[a]];if(t.layer<0&&!t.failed)return!1}return!0}get allFailed(){return this.slots.every(e=>e.failed)}draw(e,a){let{gl:t,stats:i}=this;if(i.drawCalls=i.triangles=i.drawn=0,i.there===0)return;this.setClip(e);let r=e.worldFromEye;t.useProgram(this.program.program);let{at:o}=this.program;t.uniformMatrix4fv(o.clip_from_local,!1,this.clip),t.uniform4f(o.forward_near,-r[8],-r[9],-r[10],a),this.bind(),t.bindVertexArray(this.vertices),this.surfaces?this.drawSurfaces(r):this.drawBoards(r),t.bindVertexArray(null),i.drawCalls=1}dispose(){let{gl:e}=this;this.disposed=!0;for(let a of this.slots)a.next?.colors.close();for(let a of Object.values(this.textures))e.deleteTexture(a);e.deleteProgram(this.program.program),e.deleteVertexArray(this.vertices),e.deleteBuffer(this.instances)}link(e,a,t){let{gl:i}=this,r=q(i,e,a,t);return i.useProgram(r),se.forEach((o,n)=>i.uniform1i(i.getUniformLocation(r,`${o}_texture`),n)),{program:r,at:Object.fromEntries(ha.map(o=>[o,i.getUniformLocation(r,o)]))}}makeTextures(){let{gl:e,width:a,height:t}=this,i=(r,o,n=a,c=t,b=e.NEAREST)=>{let h=e.createTexture();e.bindTexture(e.TEXTURE_2D_ARRAY,h),e.texStorage3D(e.TEXTURE_2D_ARRAY,1,o,n,c,this.layers),e.texParameteri(e.TEXTURE_2D_ARRAY,e.TEXTURE_MIN_FILTER,b),e.texParameteri(e.TEXTURE_2D_ARRAY,e.TEXTURE_MAG_FILTER,b),this.textures[r]=h};if(i("color",e.RGBA8,a,t,e.LINEAR),i("code",e.R16UI),this.surfaces){let r=V(a,t);i("slope",e.RG32UI),i("links",e.R8UI),i("cell",e.RG32F,r.columns,r.rows)}e.bindTexture(e.TEXTURE_2D_ARRAY,null)}bind(){let{gl:e,textures:a}=this;for(let t=0;t<se.length;++t)e.activeTexture(e.TEXTURE0+t),e.bindTexture(e.TEXTURE_2D_ARRAY,a[se[t]]??null);e.activeTexture(e.TEXTURE0)}sort(e,a,t){let{entry:i,order:r,slots:o}=this,n=i.center;for(let c=0;c<r.length;++c){let b=i.list[c],h=b.worldFromEye,l=b.direction,p=this.surfaces?-(l[0]*(e-n[0])+l[1]*(a-n[1])+l[2]*(t-n[2])):Math.hypot(h[12]-e,h[13]-a,h[14]-t);o[c].key=p;let d=c;for(;d>0&&o[r[d-1]].key>p;--d)r[d]=r[d-1];r[d]=c}for(let c=0;c<this.layers;++c)o[r[c]].lastUsed=this.frame}async load(e){let a=this.slots[e],t=this.entry.list[e],i=null;try{let r=this.host.fetch(t.depths).then(c=>this.decoder.view(c,t.depths,{width:t.width,height:t.height,du:t.du,dv:t.dv,least:t.depths.least,step:t.depths.step,sigma:t.backPerspective?-1:1,links:this.surfaces?this.entry.links:null})),o=this.host.fetch(t.colors).then(async c=>{i=await this.bitmap(await this.decoder.check(c,t.colors),t)}),[n]=await Promise.all([r,o]);if(this.disposed)throw new _("walk","was disposed of");a.next={surface:n,colors:i},this.host.arrived()}catch(r){if(i?.close(),this.disposed)return;a.failed=!0,this.host.failed(U(r,`picture ${e}`))}finally{a.coming=!1}}async bitmap(e,a){let t={premultiplyAlpha:"premultiply",colorSpaceConversion:"none"},i=await createImageBitmap(new Blob([e],{type:"image/webp"}),t).catch(()=>{throw new _(a.colors.name,"is no WebP picture that this browser reads")});if(i.width!==a.width||i.height!==a.height)throw i.close(),new _(a.colors.name,`is not ${a.width} x ${a.height} texels large`);return i}freeLayer(){let e=new Set(this.slots.map(i=>i.layer));for(let i=0;i<this.layers;++i)if(!e.has(i))return i;let a=this.slots.filter(i=>i.layer>=0).reduce((i,r)=>r.lastUsed<i.lastUsed?r:i),{layer:t}=a;return a.layer=-1,--this.stats.there,t}upload(){let{gl:e,textures:a}=this,t=0;for(;t<this.slots.length&&!this.slots[t].next;)++t;if(t===this.slots.length)return;let i=this.slots[t],r=this.entry.list[t],{surface:o,colors:n}=i.next;i.next=null;let c=this.freeLayer(),{width:b,height:h}=r,l=(p,d,m,v,g=b,w=h)=>{e.bindTexture(e.TEXTURE_2D_ARRAY,a[p]??null),e.texSubImage3D(e.TEXTURE_2D_ARRAY,0,0,0,c,g,w,1,d,m,v)};e.pixelStorei(e.UNPACK_FLIP_Y_WEBGL,!1),e.pixelStorei(e.UNPACK_PREMULTIPLY_ALPHA_WEBGL,!1),e.pixelStorei(e.UNPACK_COLORSPACE_CONVERSION_WEBGL,e.NONE),e.bindTexture(e.TEXTURE_2D_ARRAY,a.color??null),e.texSubImage3D(e.TEXTURE_2D_ARRAY,0,0,0,c,b,h,1,e.RGBA,e.UNSIGNED_BYTE,n),e.pixelStorei(e.UNPACK_COLORSPACE_CONVERSION_WEBGL,e.BROWSER_DEFAULT_WEBGL),n.close(),e.pixelStorei(e.UNPACK_ALIGNMENT,1),l("code",e.RED_INTEGER,e.UNSIGNED_SHORT,o.codes),this.surfaces&&(l("slope",e.RG_INTEGER,e.UNSIGNED_INT,o.slopes),l("links",e.RED_INTEGER,e.UNSIGNED_BYTE,o.links),this.storeCells(c,b,h,o.cells)),e.pixelStorei(e.UNPACK_ALIGNMENT,4),e.bindTexture(e.TEXTURE_2D_ARRAY,null),i.layer=c,++this.stats.there,this.host.loaded(t)}storeCells(e,a,t,i){let{gl:r}=this,o=V(a,t),n=V(this.width,this.height);r.bindTexture(r.TEXTURE_2D_ARRAY,this.textures.cell??null),r.pixelStorei(r.UNPACK_ROW_LENGTH,o.columns);for(let c=0;c<4;++c){let b=(o.levelAt[c+1]??o.columns)-o.levelAt[c];r.pixelStorei(r.UNPACK_SKIP_PIXELS,o.levelAt[c]),r.texSubImage3D(r.TEXTURE_2D_ARRAY,0,n.levelAt[c],0,e,b,o.rows,1,r.RG,r.FLOAT,i)}r.pixelStorei(r.UNPACK_SKIP_PIXELS,0),r.pixelStorei(r.UNPACK_ROW_LENGTH,0)}setClip(e){let a=e.worldFromEye,t=e.clipFromEye,i=this.clip;for(let r=0;r<3;++r)for(let o=0;o<4;++o)i[4*r+o]=t[o]*a[r]+t[4+o]*a[4+r]+t[8+o]*a[8+r];for(let r=0;r<4;++r)i[12+r]=t[12+r]}drawSurfaces(e){let{gl:a,entry:t,slots:i,stats:r}=this,{at:o}=this.program,n=0,c=0,b=0,h=t.center,l=Math.hypot(e[12]-h[0],e[13]-h[1],e[14]-h[2])||1,p=0;for(let g=0;g<this.order.length&&n<D;++g){let w=this.order[g];if(i[w].layer<0)continue;let A=Math.acos(Math.max(-1,Math.min(1,-i[w].key/l)));n===0&&(p=A);let E=n===0?1:t.handover>0?Math.max(0,1-(A-p)/t.handover):0;E>0&&++c,this.weights[n]=E,this.complete[n]=t.list[w].complete?1:0,this.shown[n++]=w,b+=E}for(let g=0;g<n;++g)this.weights[g]/=b,this.setView(g,e);r.drawn=n;let{low:d,high:m}=t,v=t.slack;a.uniform3f(o.box_min,d[0]-v-e[12],d[1]-v-e[13],d[2]-v-e[14]),a.uniform3f(o.box_max,m[0]+v-e[12],m[1]+v-e[13],m[2]+v-e[14]),a.uniform4fv(o.view_data,this.viewData),a.uniform1fv(o.view_weights,this.weights),a.uniform1fv(o.view_complete,this.complete),a.uniform2i(o.view_counts,n,c),a.enable(a.CULL_FACE),a.cullFace(a.FRONT),a.drawArrays(a.TRIANGLE_STRIP,0,14),a.cullFace(a.BACK),a.disable(a.CULL_FACE),r.triangles=12}setView(e,a){let t=this.shown[e],i=this.entry.list[t],r=i.worldFromEye,o=this.viewData,{left:n,right:c,bottom:b,top:h}=i,l=i.width,p=i.height,d=4*C*e,m=0,v=0,g=0;for(let w=0;w<3;++w){let A=r[w],E=r[4+w],j=-r[8+w],L=r[12+w]-a[12+w],y=(A-n*j)*l/(c-n),f=(h*j-E)*p/(h-b);o[d+w]=y,o[d+4+w]=f,o[d+8+w]=j,o[d+12+w]=L,o[d+16+w]=j+n*A+h*E,o[d+20+w]=A*(c-n)/l,o[d+24+w]=-E*(h-b)/p,m-=y*L,v-=f*L,g-=j*L}o[d+3]=m,o[d+7]=v,o[d+11]=g,o[d+15]=i.backPerspective?-1:1,o[d+19]=this.slots[t].layer,o[d+23]=l,o[d+27]=p,o[d+28]=i.zNear,o[d+29]=i.zFar,o[d+30]=i.depths.least,o[d+31]=i.depths.step}drawBoards(e){let{gl:a,entry:t,slots:i,stats:r,boardData:o}=this,n=0;for(let c=0;c<i.length;++c){if(i[c].layer<0)continue;let b=t.list[c],h=b.worldFromEye,l=b.planeZ,p=20*n++;for(let d=0;d<3;++d){let m=h[d],v=h[4+d],g=-h[8+d];o[p+d]=h[12+d]-e[12+d],o[p+4+d]=l*(g+b.left*m+b.top*v),o[p+8+d]=l*(b.right-b.left)*m,o[p+12+d]=-l*(b.top-b.bottom)*v}o[p+3]=i[c].layer,o[p+7]=l,o[p+11]=b.width,o[p+15]=b.height,o[p+16]=b.depths.least,o[p+17]=b.depths.step,o[p+18]=1/this.width,o[p+19]=1/this.height}a.bindBuffer(a.ARRAY_BUFFER,this.instances),a.bufferSubData(a.ARRAY_BUFFER,0,o,0,20*n),a.disable(a.CULL_FACE),a.drawArraysInstanced(a.TRIANGLE_STRIP,0,4,n),r.drawn=n,r.triangles=2*n}};var fa=192*1024*1024,pa=512*512,Ue=4,N=class{constructor(e,a,t={}){this.gl=e;this.options=t;this.stats={drawCalls:0,triangles:0,bytes:0,nodes:0,drawn:0,loading:0,loaded:0};this.manifest=null;this.decoder=new I;this.abort=new AbortController;this.chooser=null;this.pictures=null;this.slots=[];this.drawn=[];this.frame=0;this.nodeBytes=0;this.generation=0;this.eye=new Float64Array(3);this.waiting=[];this.firstPicture=null;this.failed=null;this.source=typeof a=="string"||a instanceof URL?new Y(a):a,this.budget=t.memoryBudget??fa,this.mostDrawn=Math.min(W,Math.max(1,t.nodes??2)),this.mostLoading=Math.max(1,t.connections??3),this.ready=this.open(),this.ready.catch(()=>{});try{this.drawer=new B(e)}catch(i){throw this.abort.abort(),this.decoder.dispose(),i}}update(e,a,t){let{eye:i,chooser:r}=this;++this.frame,i[0]=e,i[1]=a,i[2]=t,!this.gl.isContextLost()&&(this.pictures?.update(e,a,t),r&&(r.order(e,a,t),this.upload(),this.choose(),this.load()))}draw(e,a,t=!1){let{gl:i}=this;if(i.isContextLost())return;let r=this.drawLayers(e);r===0&&!t||(i.bindFramebuffer(i.FRAMEBUFFER,a),i.viewport(0,0,e.width,e.height),r===0?this.drawer.drawSky(e):this.drawer.merge(e,t),this.count())}drawLayers(e){let{pictures:a}=this;return a&&a.stats.there>0?(a.draw(e,this.drawer.beginOther(e)),this.drawer.endOther(),this.drawer.stats.drawCalls=a.stats.drawCalls,this.drawer.stats.triangles=a.stats.triangles,this.count(),1):this.drawn.length===0?0:(this.drawer.drawLayers(e,this.drawn,this.drawn.length),this.count(),this.drawer.layers)}drawObjects(e,a){let t=this.drawn.filter(i=>i.objects!==null);this.drawer.drawObjects(e,t,t.length,a)}get settled(){let{chooser:e}=this;if(this.pictures)return this.pictures.settled;if(!e)return this.failed!==null;for(let a=0;a<Math.min(this.mostDrawn,this.slots.length);++a){let t=this.slots[e.best[a]];if(t.level<t.most-1||t.next)return!1}return!0}restore(e){this.gl=e,++this.generation,this.drawer=new B(e),this.nodeBytes=0,this.drawn.length=0,this.pictures&&this.makePictures(this.manifest?.pictures);for(let a of this.slots){for(let t of a.next?.faces??[])t.close();a.stored=a.next=null,a.level=a.coming=-1,a.reserved=0}this.options.onNeedsDraw?.()}dispose(){++this.generation,this.abort.abort(),this.source.close(),this.decoder.dispose();for(let e of this.slots){for(let a of e.next?.faces??[])a.close();e.next&&$(this.gl,e.next.stored),e.stored&&$(this.gl,e.stored),e.stored=e.next=null}this.drawn.length=0,this.pictures?.dispose(),this.drawer.dispose()}async open(){try{let{signal:e}=this.abort,a=await this.source.manifest(e),t=new Promise(r=>this.firstPicture=r),{sketches:i}=a;if(a.pictures&&this.makePictures(a.pictures),i&&await this.openNodes(a,i),this.manifest=a,this.update(...a.start.eye),this.options.onNeedsDraw?.(),await t,this.failed)throw this.failed}catch(e){let a=U(e,"walk");throw this.failed!==a&&!this.abort.signal.aborted&&this.options.onError?.(a),this.failed=a,a}}async openNodes(e,a){let t=await this.decoder.plane16(await this.fetch(a),a,a.size,6*a.size*e.nodes.length);this.chooser=new J(e.nodes,t,a),this.slots=e.nodes.map(i=>({stored:null,level:-1,coming:-1,reserved:0,most:i.levels.length,lastUsed:0,next:null}))}makePictures(e){this.pictures?.dispose(),this.pictures=new Q(this.gl,e,this.decoder,{budget:this.budget,fetch:a=>this.fetch(a),arrived:()=>this.options.onNeedsDraw?.(),loaded:a=>{this.options.onPicture?.(a,0),this.firstPicture?.(),this.firstPicture=null},failed:a=>{this.firstPicture&&this.pictures?.allFailed&&(this.failed=a,this.firstPicture(),this.firstPicture=null),this.options.onError?.(a),this.options.onNeedsDraw?.()}})}async fetch(e){for(;this.stats.loading>=this.mostLoading;)await new Promise(a=>this.waiting.push(a));++this.stats.loading;try{let a=await this.source.file(e,this.abort.signal);return this.stats.loaded+=a.byteLength,a}finally{--this.stats.loading,this.waiting.shift()?.()}}choose(){let{chooser:e,drawn:a,slots:t}=this;if(e){a.length=0;for(let i=0;i<t.length&&a.length<this.mostDrawn;++i){let r=t[e.best[i]];r.stored&&(r.lastUsed=this.frame,a.push(r.stored))}}}load(){let{chooser:e,slots:a}=this;if(!e)return;let t=0;for(let n=0;n<a.length;++n)a[n].coming>=0&&++t;let i=a.length,r=Math.min(this.mostDrawn,i),o=Math.min(r+Ue,i);for(let n=0;n<4&&t<2;++n){let c=n<2?r:n===2?o:i;for(let b=0;b<c&&t<2;++b){let h=e.best[b],l=a[h];if(l.coming>=0||l.next)continue;let p=n===0||n===3?0:Math.max(l.level+1,0);if(l.level>=p||p>=l.most)continue;let d=this.expectedBytes(h,p);if(!this.makeRoom(d,b<r))return;l.coming=p,l.reserved=d,this.nodeBytes+=d,++t,this.loadLevel(h,p)}}}expectedBytes(e,a){let t=this.manifest?.nodes[e].levels[a],{mesh:i}=t;return 6*(ie+(t.objects&&this.options.objects?oe:0))*t.faceSize*t.faceSize+8*i.surfaceVertices.count+16*i.skinVertices.count+4*(i.surfaceIndices.count+i.skinIndices.count)}makeRoom(e,a){let{chooser:t,slots:i}=this,r=Math.min(this.mostDrawn+Ue,i.length);for(;this.nodeBytes+e>this.budget;){let o=-1;for(let n=a?this.mostDrawn:r;n<i.length;++n){let c=t?.best[n];i[c].stored&&i[c].coming<0&&!i[c].next&&(o<0||i[c].lastUsed<i[o].lastUsed)&&(o=c)}if(o<0)return a;this.drop(i[o])}return!0}release(e){this.nodeBytes-=e.reserved,e.reserved=0}drop(e){e.stored&&(this.nodeBytes-=e.stored.bytes,$(this.gl,e.stored),e.stored=null,e.level=-1)}async loadLevel(e,a){let{generation:t}=this,i=this.slots[e],r=this.manifest?.nodes[e],o=r?.levels[a];if(!r||!o)return;let n=[];try{let c=this.fetch(o.mesh).then(g=>this.decoder.mesh(g,o.mesh)),b=this.fetch(o.weights).then(g=>this.decoder.shares(g,o.weights,3*o.faceSize,2*o.faceSize)),h=o.objects&&this.options.objects?this.fetch(o.objects).then(g=>this.decoder.plane16(g,o.objects,3*o.faceSize,2*o.faceSize)):null,l=this.fetch(o.colors).then(g=>this.faces(g,o,n)),[p,d,m]=await Promise.all([c,b,h,l]);if(t!==this.generation)throw new _("walk","is another by now");let v=_e(this.gl,r.worldFromNode,o,p,d,m);this.release(i),this.nodeBytes+=v.bytes,i.next={stored:v,level:a,faces:n},i.coming=-1,this.options.onNeedsDraw?.()}catch(c){for(let h of n)h.close();if(t!==this.generation)return;this.release(i),i.coming=-1,i.most=a;let b=U(c,`node ${e}`);this.firstPicture&&this.slots.every(h=>h.most===0||h.stored)&&(this.failed=b,this.firstPicture(),this.firstPicture=null),this.options.onError?.(b),this.options.onNeedsDraw?.()}}async faces(e,a,t){let i=await this.decoder.check(e,a.colors),r={premultiplyAlpha:"none",colorSpaceConversion:"none"},o=await createImageBitmap(new Blob([i],{type:"image/webp"}),r).catch(()=>{throw new _(a.colors.name,"is no WebP picture that this browser reads")}),n=a.faceSize;if(o.width!==3*n||o.height!==2*n)throw new _(a.colors.name,`is not ${3*n} x ${2*n} texels large`);try{for(let c=0;c<6;++c)t.push(await createImageBitmap(o,c%3*n,Math.floor(c/3)*n,n,n,r))}finally{o.close()}}upload(){let{chooser:e,slots:a}=this;if(e)for(let t=0;t<a.length;++t){let i=e.best[t],r=a[i],o=r.next;if(!o)continue;let{stored:n}=o;this.options.onNeedsDraw?.();let c=n.level.faceSize*n.level.faceSize;for(let b=pa;b>0&&n.uploaded<6;b-=c){let h=o.faces[n.uploaded];Ae(this.gl,n,h,this.drawer.weightWriter),h.close()}if(n.uploaded<6)return;this.drawer.seenDrawer.draw(n),this.drop(r),r.stored=n,r.level=o.level,r.next=null,this.options.onPicture?.(i,o.level),this.firstPicture?.(),this.firstPicture=null;return}}count(){let{stats:e,drawer:a}=this;e.drawCalls=a.stats.drawCalls,e.triangles=a.stats.triangles,e.drawn=a.layers,e.bytes=this.nodeBytes+a.bytes+(this.pictures?.bytes??0);let t=0;for(let i=0;i<this.slots.length;++i)this.slots[i].stored&&++t;e.nodes=t}};var De={KeyW:["ahead",1],ArrowUp:["ahead",1],KeyS:["ahead",-1],ArrowDown:["ahead",-1],KeyD:["aside",1],KeyA:["aside",-1],KeyE:["above",1],PageUp:["above",1],KeyQ:["above",-1],PageDown:["above",-1],ArrowLeft:["turn",1],ArrowRight:["turn",-1]};function ne(s,e){return[s[1]*e[2]-s[2]*e[1],s[2]*e[0]-s[0]*e[2],s[0]*e[1]-s[1]*e[0]]}function Z(s){let e=Math.hypot(s[0],s[1],s[2])||1;return[s[0]/e,s[1]/e,s[2]/e]}var ee=class{constructor(e,a){this.moved=a;this.eye=new Float64Array(3);this.speed=1.4;this.yaw=0;this.pitch=0;this.worldFromEye=new Float64Array(16);this.up=[0,1,0];this.north=[0,0,-1];this.east=[1,0,0];this.held=new Set;this.touches=new Map;this.removers=[];this.spread=0;e.tabIndex=0,e.style.touchAction="none",e.style.outline="none";let t=(i,r,o,n)=>{i.addEventListener(r,o,n),this.removers.push(()=>i.removeEventListener(r,o,n))};t(window,"keydown",i=>{!De[i.code]||i.ctrlKey||i.metaKey||i.altKey||(i.preventDefault(),this.held.add(i.code),i.shiftKey&&this.held.add("Shift"),this.moved())}),t(window,"keyup",i=>{this.held.delete(i.code),i.key==="Shift"&&this.held.delete("Shift")}),t(window,"blur",()=>this.held.clear()),t(e,"pointerdown",i=>{this.touches.set(i.pointerId,{x:i.clientX,y:i.clientY}),this.spread=this.fingersApart(),e.setPointerCapture?.(i.pointerId),e.focus({preventScroll:!0})}),t(e,"pointermove",i=>this.drag(i));for(let i of["pointerup","pointercancel"])t(e,i,r=>{this.touches.delete(r.pointerId),this.spread=this.fingersApart()});t(e,"wheel",i=>{i.preventDefault(),this.step(-.002*i.deltaY*this.speed,0,0),this.moved()},{passive:!1})}stand(e,a,t){this.up=Z(t);let i=Z([a[0]-e[0],a[1]-e[1],a[2]-e[2]]),r=i[0]*this.up[0]+i[1]*this.up[1]+i[2]*this.up[2],o=ne(i,this.up);Math.hypot(...o)<1e-6&&(o=ne([this.up[1],this.up[2],this.up[0]],this.up)),this.east=Z(o),this.north=Z(ne(this.up,this.east)),this.yaw=0,this.pitch=Math.max(-1.5,Math.min(1.5,Math.asin(Math.max(-1,Math.min(1,r))))),this.eye.set(e),this.place()}advance(e){let a=0,t=0,i=0,r=0,o=0;for(let b of this.held){let[h,l]=De[b]??["",0];h==="ahead"&&(a+=l),h==="aside"&&(t+=l),h==="above"&&(i+=l),h==="turn"&&(r+=l)}let n=typeof navigator.getGamepads=="function"?navigator.getGamepads():[];for(let b of n){if(!b)continue;let h=l=>{let p=b.axes[l]??0;return Math.abs(p)>.15?p:0};t+=h(0),a-=h(1),r-=h(2),o-=h(3)}if(!a&&!t&&!i&&!r&&!o)return!1;let c=e*this.speed*(this.held.has("Shift")?3:1);return this.turn(r*1.6*e,o*1.6*e),this.step(a*c,t*c,i*c),!0}get active(){if(this.held.size>0||this.touches.size>0)return!0;if(typeof navigator.getGamepads!="function")return!1;for(let e of navigator.getGamepads())if(e)return!0;return!1}dispose(){for(let e of this.removers)e()}drag(e){let a=this.touches.get(e.pointerId);if(!a)return;let t=e.clientX-a.x,i=e.clientY-a.y;if(a.x=e.clientX,a.y=e.clientY,this.touches.size>1){let r=1/this.touches.size,o=this.fingersApart();this.step(.01*(o-this.spread)+.01*i*r,-.01*t*r,0),this.spread=o}else this.turn(t*.004,i*.004);this.moved()}fingersApart(){if(this.touches.size!==2)return 0;let[e,a]=[...this.touches.values()];return Math.hypot(e.x-a.x,e.y-a.y)}turn(e,a){this.yaw+=e,this.pitch=Math.max(-1.5,Math.min(1.5,this.pitch+a)),this.place()}step(e,a,t){let i=this.worldFromEye;for(let r=0;r<3;++r)this.eye[r]+=-i[8+r]*e+i[r]*a+this.up[r]*t;this.place()}place(){let{north:e,east:a,up:t,worldFromEye:i}=this,r=Math.cos(this.yaw),o=Math.sin(this.yaw),n=Math.cos(this.pitch),c=Math.sin(this.pitch);for(let b=0;b<3;++b){let h=e[b]*r-a[b]*o;i[b]=a[b]*r+e[b]*o,i[4+b]=t[b]*n-h*c,i[8+b]=-(h*n+t[b]*c),i[12+b]=this.eye[b]}i[3]=i[7]=i[11]=0,i[15]=1}};var ce=4096;function ma(s){let e=document.createElement("div");return e.setAttribute("role","alert"),e.style.cssText="position:absolute;left:50%;top:50%;transform:translate(-50%,-50%);max-width:min(36em,86%);padding:1em 1.3em;border-radius:8px;background:#20262ef0;color:#e8eaed;display:none;font:16px/1.5 system-ui,sans-serif;overflow-wrap:anywhere;white-space:pre-line",s.append(e),{show(a){e.textContent=a,e.style.display="block"},hide(){e.style.display="none"}}}function ua(s){let e=document.createElement("div");return e.style.cssText="position:absolute;left:0;right:0;bottom:0;padding:.5em 1em;color:#e8eaedcc;pointer-events:none;font:13px/1.4 system-ui,sans-serif;text-shadow:0 1px 2px #000",s.append(e),a=>{e.textContent!==a&&(e.textContent=a)}}function ga(s,e,a={}){getComputedStyle(s).position==="static"&&(s.style.position="relative");let t=document.createElement("canvas");t.style.cssText="position:absolute;inset:0;width:100%;height:100%;display:block",t.setAttribute("aria-label","A walk. Drag to look, arrow keys or W A S D to walk."),s.append(t);let i=ma(s),r=ua(s),o={update:new Float32Array(ce),draw:new Float32Array(ce),frames:0},n=null,c=!1,b=!1,h=0,l=0,p=null,d="",m=()=>{!h&&!b&&(h=requestAnimationFrame(y))},v=new ee(t,m),g=t.getContext("webgl2",{antialias:!1,alpha:!1,powerPreference:"high-performance",preserveDrawingBuffer:a.preserveDrawingBuffer??!1});if(!g){let k=new _("browser","has no WebGL 2, which walks are drawn with: update it, or switch hardware acceleration on");i.show(`This walk cannot be shown. The ${k.message}.`),a.onError?.(k);let R=Promise.reject(k);return R.catch(()=>{}),{canvas:t,controls:v,walk:n,ready:R,times:o,draw(){},setView(){},view:()=>({worldFromEye:v.worldFromEye,clipFromEye:new Float64Array(16),width:1,height:1}),dispose(){v.dispose(),s.replaceChildren()}}}let w=new Float64Array(16),A={worldFromEye:v.worldFromEye,clipFromEye:w,width:1,height:1},E=()=>{let k=a.pixelRatio??Math.min(2,window.devicePixelRatio||1),R=Math.max(1,Math.round(t.clientWidth*k)),T=Math.max(1,Math.round(t.clientHeight*k));(t.width!==R||t.height!==T)&&(t.width=R,t.height=T),A.width=R,A.height=T;let G=n?.manifest?.start,P=G?.zNear??.1,z=G?.zFar??1e3,be=1/Math.tan(.5*(G?.verticalFov??.9));w.fill(0),w[0]=be*T/R,w[5]=be,w[10]=-(z+P)/(z-P),w[11]=-1,w[14]=-2*z*P/(z-P)},j=new ResizeObserver(m);j.observe(t);let L=()=>{if(!n||c||b)return;E();let k=p??A,R=k.worldFromEye,T=performance.now();n.update(R[12],R[13],R[14]);let G=performance.now();g.bindFramebuffer(g.FRAMEBUFFER,null),g.viewport(0,0,t.width,t.height),g.clearColor(.063,.078,.094,1),g.clear(g.COLOR_BUFFER_BIT|g.DEPTH_BUFFER_BIT),n.draw(k,null,a.sky??!0);let P=o.frames++%ce;o.update[P]=G-T,o.draw[P]=performance.now()-G},y=k=>{h=0;let R=Math.min(.1,l?(k-l)/1e3:1/60);l=k,v.advance(R);try{L()}catch(G){i.show(`This walk cannot be drawn. ${U(G,"drawing").message}.`);return}let T=n?!n.settled:!1;r(d||(T?"Loading\u2026":"")),v.active||T?m():l=0};try{n=new N(g,e,{...a,onNeedsDraw(){m(),a.onNeedsDraw?.()},onError(k){n?.manifest&&(d=`Something is missing: ${k.message}.`),m(),a.onError?.(k)}})}catch(k){i.show(`This walk cannot be drawn. ${U(k,"WebGL").message}.`)}let u=(n?.ready??Promise.reject(new _("WebGL","cannot be used"))).catch(k=>{throw b||i.show(`This walk cannot be loaded. ${U(k,"walk").message}.`),k});u.catch(()=>{}),r("Loading\u2026");let x=()=>{let k=n?.manifest;k&&(v.stand(k.start.eye,k.start.target,k.up),document.title=k.name||document.title)};u.then(()=>{x(),m()},()=>{});let F=k=>{k.preventDefault(),c=!0,i.show("The browser took the graphics away. The walk goes on when it gives them back.")},S=()=>{c=!1;try{n?.restore(g),i.hide()}catch(k){i.show(`This walk cannot be drawn. ${U(k,"WebGL").message}.`)}m()};return t.addEventListener("webglcontextlost",F),t.addEventListener("webglcontextrestored",S),m(),{canvas:t,controls:v,ready:u,times:o,draw:L,get walk(){return n},view:()=>p??A,setView(k){p=k,m()},dispose(){b=!0,cancelAnimationFrame(h),j.disconnect(),t.removeEventListener("webglcontextlost",F),t.removeEventListener("webglcontextrestored",S),v.dispose(),n?.dispose(),s.replaceChildren()}}}return Ne(wa);})();
