// Generated from web/src by web/tools/build.js: do not edit.
var x=class extends Error{constructor(o,i){super(`${o}: ${i}`);this.where=o;this.reason=i;this.name="WalkError"}};function S(c,e){return c instanceof x?c:new x(e,c instanceof Error?c.message:String(c))}function q(c,e,o,i){let t=c.createProgram();if(!t)throw new Error(`${e}: the WebGL context is lost`);for(let[r,a]of[[c.VERTEX_SHADER,o],[c.FRAGMENT_SHADER,i]]){let s=c.createShader(r);if(!s)throw new Error(`${e}: the WebGL context is lost`);c.shaderSource(s,a),c.compileShader(s),c.attachShader(t,s),c.deleteShader(s)}return c.linkProgram(t),t}function G(c,e,o){if(c.getProgramParameter(o,c.LINK_STATUS)||c.isContextLost())return;let i=(c.getAttachedShaders(o)??[]).map(t=>c.getShaderInfoLog(t));throw new Error(`${e}: ${[c.getProgramInfoLog(o),...i].join(" ").trim()}`)}function F(c,e,o,i){let t=q(c,e,o,i);return G(c,e,t),t}function U(c,e){let o=c.worldFromEye,i=c.clipFromEye;for(let t=0;t<3;++t)for(let r=0;r<4;++r)e[4*t+r]=i[r]*o[t]+i[4+r]*o[4+t]+i[8+r]*o[8+t];for(let t=0;t<4;++t)e[12+t]=i[12+t]}async function P(c,e,o,i){let t={premultiplyAlpha:"premultiply",colorSpaceConversion:"none"},r=await createImageBitmap(new Blob([c],{type:"image/webp"}),t).catch(()=>{throw new x(e.name,"is no WebP picture that this browser reads")});if(r.width!==o||r.height!==i)throw r.close(),new x(e.name,`is not ${o} x ${i} texels large`);return r}var B=`#version 300 es
precision highp float;
layout(location=0)in vec4 eye_layer;
layout(location=1)in vec4 corner_plane;
layout(location=2)in vec4 right_width;
layout(location=3)in vec4 down_height;
layout(location=4)in vec4 depths;
uniform mat4 clip_from_local;
uniform vec4 forward_near;
out vec2 v_uv;
out float v_towards;
flat out vec4 v_depths;
flat out vec4 v_size_layer_eye;
flat out float v_plane;
void main(){
vec2 corner=vec2(gl_VertexID&1,gl_VertexID>>1);
vec3 p=corner_plane.xyz + corner.x*right_width.xyz + corner.y*down_height.xyz;
gl_Position=clip_from_local*vec4(eye_layer.xyz + p,1.0);
gl_Position.z=0.0;
v_uv=corner*vec2(right_width.w,down_height.w);
v_towards=dot(forward_near.xyz,p);
v_depths=depths;
v_size_layer_eye=vec4(right_width.w,down_height.w,eye_layer.w,
dot(forward_near.xyz,eye_layer.xyz));
v_plane=corner_plane.w;
}
`,I=`#version 300 es
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
layout(location=0)out vec4 out_color;
void main(){
vec2 uv=clamp(v_uv,vec2(0.5),v_size_layer_eye.xy - 0.5);
uint code=texelFetch(code_texture,ivec3(uv,v_size_layer_eye.z),0).r;
vec4 color=texture(color_texture,vec3(uv*v_depths.zw,v_size_layer_eye.z));
if(code==0u||color.a<0.5)discard;
float q=v_depths.x + float(code - 1u)*v_depths.y;
float eye_z=v_size_layer_eye.w + v_towards/(q*v_plane);
if(eye_z<=0.0)discard;
gl_FragDepth=clamp(1.0 - forward_near.w/eye_z,0.0,1.0);
out_color=vec4(color.rgb/color.a,1.0);
}
`;function A(c,e){let o=[],i=0,t=4;for(let r=0;r<4;++r,t*=4)o.push(i),i+=Math.ceil(c/t);return{columns:i,rows:Math.ceil(e/4),levelAt:o}}var O=new Float32Array(1),Q=new Uint32Array(O.buffer);var _=10,Y=6,g=8,D=`#version 300 es
precision highp float;
uniform mat4 clip_from_local;
uniform vec3 box_min,box_max;
out vec3 v_ray;
void main(){
const int kStrip[14]=int[](6,7,4,5,1,7,3,6,2,4,0,1,2,3);
int c=kStrip[gl_VertexID];
v_ray=mix(box_min,box_max,vec3(c>>2,c>>1&1,c&1));
gl_Position=clip_from_local*vec4(v_ray,1.0);
gl_Position.z=0.0;
}
`,V=`#version 300 es
precision highp float;
precision highp int;
precision highp sampler2DArray;
precision highp usampler2DArray;
#define BLOCK_BITS ${Math.log2(4)}
#define FACTOR_BITS ${Math.log2(4)}
#define BLOCK ${4}
#define LEVELS ${4}
#define PATCH_GAP 0.25
#define SURE 0.25
in vec3 v_ray;
uniform vec3 box_min,box_max;
uniform vec4 view_data[${_*g}];
uniform float view_weights[${_}];
uniform vec2 view_says[${_}];
uniform ivec2 view_counts;
uniform vec4 forward_near;
uniform int level_at[LEVELS];
uniform sampler2DArray color_texture;
uniform usampler2DArray code_texture;
uniform usampler2DArray slope_texture;
uniform usampler2DArray links_texture;
uniform sampler2DArray cell_texture;
layout(location=0)out vec4 out_color;
struct View{vec4 u_row,v_row,w_row,apex,base,du,dv,depths;};
View view_at(int i){
int k=${g}*i;
return View(view_data[k],view_data[k + 1],view_data[k + 2],view_data[k + 3],view_data[k + 4],
view_data[k + 5],view_data[k + 6],view_data[k + 7]);
}
struct March{bool hit,behind,outline;float s,behind_from,behind_to;ivec2 texel;};
float q_of(vec4 depths,ivec3 texel){
uint code=texelFetch(code_texture,texel,0).r;
return code==0u?0.0:depths.z + float(code - 1u)*depths.w;
}
bool frustum_segment(View view,vec3 ray,inout vec2 t,out vec3 from,out vec3 to){
vec3 c=vec3(view.u_row.w,view.v_row.w,view.w_row.w);
vec3 d=vec3(dot(view.u_row.xyz,ray),dot(view.v_row.xyz,ray),dot(view.w_row.xyz,ray));
vec3 p=c + t.x*d,q=c + t.y*d;
vec2 size=vec2(view.du.w,view.dv.w);
float at_p[6]=float[](p.z - view.depths.x,view.depths.y - p.z,p.x,p.y,
size.x*p.z - p.x,size.y*p.z - p.y);
float at_q[6]=float[](q.z - view.depths.x,view.depths.y - q.z,q.x,q.y,
size.x*q.z - q.x,size.y*q.z - q.y);
float begin=0.0,end=1.0;
for(int i=0;i<6;++i){
if(at_p[i]<0.0&&at_q[i]<0.0)end=-1.0;
float s=at_p[i]/(at_p[i] - at_q[i]);
if(at_p[i]<0.0)begin=max(begin,s);
else if(at_q[i]<0.0)end=min(end,s);
}
t=mix(t.xx,t.yy,vec2(begin,end));
vec3 a=mix(p,q,begin),b=mix(p,q,end);
from=vec3(a.xy,1.0)/a.z;
to=vec3(b.xy,1.0)/b.z;
return begin<end;
}
vec4 slope_of(ivec3 texel){
uvec2 halves=texelFetch(slope_texture,texel,0).rg;
return vec4(unpackHalf2x16(halves.x),unpackHalf2x16(halves.y));
}
float side_of(float sigma,vec3 p,ivec2 texel,float q,vec4 slope){
if(q==0.0)return 1.0;
vec2 d=p.xy -(vec2(texel)+ 0.5);
vec2 s=mix(slope.zw,slope.xy,greaterThanEqual(d,vec2(0.0)));
return sigma*(p.z - q - dot(abs(d),s));
}
vec2 exits(ivec2 low,int side,vec2 from,vec2 inverse,vec2 ahead){
return(vec2(low)+ ahead*float(side)- from)*inverse;
}
March march_view(View view,vec3 from,vec3 to){
March march=March(false,false,false,0.0,0.0,0.0,ivec2(0));
float sigma=view.apex.w;
int layer=int(view.base.w);
ivec2 size=ivec2(view.du.w,view.dv.w);
vec3 delta=to - from;
vec2 inverse=1.0/mix(delta.xy,vec2(1e-12),lessThan(abs(delta.xy),vec2(1e-12)));
vec2 ahead=step(vec2(0.0),inverse);
ivec2 forward=ivec2(ahead)*2 - 1;
ivec2 texel=clamp(ivec2(floor(from.xy)),ivec2(0),size - 1),moved=ivec2(0);
float t=0.0,before=1.0;
float leave=0.0,enters=0.0;
int level=LEVELS - 1;
bool done=false;
int steps=0;
do{
bool near=false;
do{
int side=BLOCK<<(level*FACTOR_BITS);
ivec2 at=texel>>(BLOCK_BITS + level*FACTOR_BITS),low=at*side;
vec2 cell=texelFetch(cell_texture,ivec3(at.x + level_at[level],at.y,layer),0).rg;
vec2 ends=exits(low,side,from.xy,inverse,ahead);
float end=min(min(ends.x,ends.y),1.0);
vec2 z=sigma*(from.z + delta.z*vec2(t,end));
bool in_front=min(z.x,z.y)>cell.x;
bool behind=before<=0.0&&max(z.x,z.y)<sigma*abs(cell.y)&&
(cell.y>0.0||march.outline);
if(in_front||behind){
bool across=ends.x<=ends.y;
ivec2 inside=clamp(ivec2(floor(from.xy + delta.xy*end)),low,low +(side - 1));
texel=across?ivec2(low.x +(forward.x>0?side:-1),inside.y)
:ivec2(inside.x,low.y +(forward.y>0?side:-1));
moved=across?ivec2(forward.x,0):ivec2(0,forward.y);
if(in_front&&before<=0.0)march.behind_to=t;
t=end;
before=in_front?1.0:-1.0;
done=end>=1.0||any(lessThan(texel,ivec2(0)))||any(greaterThanEqual(texel,size));
int coarser=BLOCK_BITS +(level + 1)*FACTOR_BITS;
if(level + 1<LEVELS&&(texel>>coarser)!=(low>>coarser))++level;
} else if(level>0){
--level;
} else{
near=true;
}
} while(!near&&!done);
if(done)break;
ivec2 block=texel>>BLOCK_BITS;
bool edge=false;
do{
float q=q_of(view.depths,ivec3(texel,layer));
vec4 slope=slope_of(ivec3(texel,layer));
enters=side_of(sigma,from + delta*t,texel,q,slope);
edge=before>0.0&&enters<=0.0;
vec2 ends=exits(texel,1,from.xy,inverse,ahead);
leave=min(min(ends.x,ends.y),1.0);
float leaves=side_of(sigma,from + delta*leave,texel,q,slope);
if(before<=0.0&&max(enters,leaves)>0.0)march.behind_to=enters>0.0?t:leave;
march.hit=enters>0.0&&leaves<=0.0;
done=march.hit||(!edge&&leave>=1.0);
if(!edge&&!done){
moved=ends.x<=ends.y?ivec2(forward.x,0):ivec2(0,forward.y);
texel +=moved;
t=leave;
before=leaves;
done=any(lessThan(texel,ivec2(0)))||any(greaterThanEqual(texel,size));
}
} while(!done&&!edge&&(texel>>BLOCK_BITS)==block);
if(edge){
ivec3 beyond=ivec3(texel - moved,layer);
int link=moved.x !=0?(moved.x>0?0:4):(moved.y>0?2:6);
bool hole=moved==ivec2(0)||q_of(view.depths,beyond)==0.0;
bool linked=!hole&&(texelFetch(links_texture,beyond,0).r>>link&1u)!=0u;
if(linked){
float q=q_of(view.depths,beyond);
float passed=side_of(sigma,from + delta*t,beyond.xy,q,slope_of(beyond));
linked=passed - enters<=PATCH_GAP*q*min(length(view.du.xyz),length(view.dv.xyz));
}
march.hit=linked;
march.s=t;
march.texel=linked?texel:beyond.xy;
if(!march.behind)march.behind_from=t;
march.behind=march.behind||!linked;
march.outline=march.outline||hole;
done=linked;
leave=t;
before=-1.0;
}
if((texel>>(BLOCK_BITS + FACTOR_BITS))!=(block>>FACTOR_BITS))level=min(1,LEVELS - 1);
} while(!done&&++steps<16384);
if(!march.hit&&before<=0.0)march.behind_to=1.0;
if(march.hit&&leave>t){
float q=q_of(view.depths,ivec3(texel,layer));
vec4 slope=slope_of(ivec3(texel,layer));
vec2 middle=clamp((vec2(texel)+ 0.5 - from.xy)*inverse,t,leave);
vec4 at=vec4(t,min(middle.x,middle.y),max(middle.x,middle.y),leave);
vec4 s=vec4(enters,side_of(sigma,from + delta*at.y,texel,q,slope),
side_of(sigma,from + delta*at.z,texel,q,slope),
side_of(sigma,from + delta*at.w,texel,q,slope));
vec4 piece=s.y<=0.0?vec4(at.xy,s.xy)
:s.z<=0.0?vec4(at.yz,s.yz):vec4(at.zw,s.zw);
march.s=piece.x +(piece.y - piece.x)*clamp(piece.z/(piece.z - piece.w),0.0,1.0);
march.texel=texel;
}
return march;
}
vec4 color_at(int layer,March march,vec2 at){
vec2 offset=at -(vec2(march.texel)+ 0.5),f=min(abs(offset),0.5);
ivec2 s=ivec2(offset.x>=0.0?1:-1,offset.y>=0.0?1:-1);
uint links=texelFetch(links_texture,ivec3(march.texel,layer),0).r;
int x=s.x>0?0:4,y=s.y>0?2:6;
int xy=s.x>0?(s.y>0?1:7):(s.y>0?3:5);
float wx=(links>>x&1u)!=0u?f.x:0.0;
float wy=(links>>y&1u)!=0u?f.y:0.0;
float wxy=(links>>xy&1u)!=0u?wx*wy:0.0;
wx -=wxy;
wy -=wxy;
vec4 sum=(1.0 - wx - wy - wxy)*texelFetch(color_texture,ivec3(march.texel,layer),0);
if(wx>0.0)sum +=wx*texelFetch(color_texture,ivec3(march.texel + ivec2(s.x,0),layer),0);
if(wy>0.0)sum +=wy*texelFetch(color_texture,ivec3(march.texel + ivec2(0,s.y),layer),0);
if(wxy>0.0)sum +=wxy*texelFetch(color_texture,ivec3(march.texel + s,layer),0);
return sum;
}
float looks_along(vec4 apex,vec3 middle){
return apex.w*dot(normalize(middle - apex.xyz),middle);
}
int view_along(vec3 middle,uint done,float least){
int best=-1;
for(int k=view_counts.y;k<view_counts.x;++k){
if((done>>k&1u)!=0u)continue;
float along=looks_along(view_data[${g}*k + 3],middle);
if(along>least||(along==least&&best<0)){
best=k;
least=along;
}
}
return best;
}
float ray_at(vec2 stretch,float from_q,float to_q,float s){
return mix(stretch.x*from_q,stretch.y*to_q,s)/mix(from_q,to_q,s);
}
void main(){
vec3 a=box_min/v_ray,b=box_max/v_ray;
vec3 lo=min(a,b);
vec2 t=vec2(max(max(max(lo.x,lo.y),lo.z),1e-6),1.0);
float speed=dot(forward_near.xyz,v_ray);
vec4 blended=vec4(0.0),doubtful_color=vec4(0.0);
float surface=0.0,nothing=0.0,heaviest=0.0;
float depth=1e38,doubtful_depth=1e38;
bool skin=false,sees_through=false;
int inside=0;
float beyond_from=2.0,free_to=0.0,beyond_depth=1e38,known_along=-1e30;
vec4 beyond_color=vec4(0.0);
uint done=0u;
vec3 middle=0.5*(t.x + t.y)*v_ray;
int asked=min(view_counts.x,${Y});
for(int i=0;i<asked;++i){
bool weighty=i<view_counts.y;
int chosen=i;
if(!weighty){
if(surface + nothing>=0.999*SURE||beyond_from<=free_to)break;
chosen=view_along(middle,done,known_along);
if(chosen<0)break;
}
float weight=weighty?view_weights[i]:SURE - surface - nothing;
done|=1u<<chosen;
View view=view_at(chosen);
vec2 says=view_says[chosen];
vec3 from,to;
vec2 stretch=t;
March march=March(false,false,false,0.0,0.0,0.0,ivec2(0));
if(frustum_segment(view,v_ray,stretch,from,to))march=march_view(view,from,to);
bool empty=!march.hit&&says.x>0.0,nearer=false;
if(march.behind){
free_to=max(free_to,ray_at(stretch,from.z,to.z,march.behind_from));
float out_at=march.behind_to<1.0?ray_at(stretch,from.z,to.z,march.behind_to):2.0;
nearer=(march.hit||empty)&&out_at<beyond_from;
if(nearer){
beyond_from=out_at;
beyond_depth=1e38;
}
} else if(weighty&&(march.hit||empty)){
known_along=max(known_along,looks_along(view.apex,middle));
}
if(!march.hit){
if(!march.behind){
nothing +=weight*says.x;
sees_through=sees_through||says.y>0.0;
}
if(march.behind)inside +=march.outline?-1:1;
if(!march.behind||march.outline)continue;
if(doubtful_depth<1e37||skin)continue;
}
int layer=int(view.base.w);
float z=ray_at(stretch,from.z,to.z,march.s)*speed;
vec4 c=color_at(layer,march,mix(from.xy,to.xy,march.s));
if(!march.hit||skin||z<doubtful_depth){
doubtful_depth=z;
doubtful_color=c;
skin=!march.hit;
}
if(nearer&&march.hit){
beyond_depth=z;
beyond_color=c;
}
if(!march.hit||march.behind)continue;
surface +=weight;
blended +=weight*c;
if(weight>heaviest){
heaviest=weight;
depth=z;
}
}
if(surface + nothing<0.999*SURE&&beyond_from<=free_to){
float weight=SURE - surface - nothing;
if(beyond_depth>1e37){
nothing +=weight;
} else{
surface +=weight;
blended +=weight*beyond_color;
if(weight>heaviest)depth=beyond_depth;
}
}
if(skin&&(inside<=0||view_counts.x==1))doubtful_depth=1e38;
if(nothing>surface||(surface==0.0&&sees_through))discard;
if(surface==0.0){
depth=doubtful_depth;
blended=doubtful_color;
surface=1.0;
}
if(depth>1e37)discard;
gl_FragDepth=clamp(1.0 - forward_near.w/depth,0.0,1.0);
blended/=surface;
out_color=vec4(blended.rgb/max(blended.a,1e-3),1.0);
}
`;var N=6,K=N+8+1+1,R=["color","code","slope","links","cell"],X=["clip_from_local","box_min","box_max","view_data","view_weights","view_says","view_counts","forward_near"],C=class{constructor(e,o,i,t){this.gl=e;this.entry=o;this.decoder=i;this.host=t;this.stats={drawCalls:0,triangles:0,there:0,drawn:0};this.textures={};this.instances=null;this.viewData=new Float32Array(4*g*_);this.weights=new Float32Array(_);this.says=new Float32Array(2*_);this.shown=new Int32Array(_);this.clip=new Float32Array(16);this.frame=0;this.disposed=!1;let{list:r}=o;this.surfaces=o.drawn==="surfaces",this.width=Math.max(...r.map(s=>s.width)),this.height=Math.max(...r.map(s=>s.height));let a=this.width*this.height*(this.surfaces?K:N);if(this.layers=Math.min(r.length,e.getParameter(e.MAX_ARRAY_TEXTURE_LAYERS),Math.max(_,Math.floor(t.budget/a))),this.bytes=this.layers*a,this.slots=r.map(()=>({layer:-1,coming:!1,failed:!1,lastUsed:0,key:0,next:null})),this.order=Uint32Array.from(r,(s,l)=>l),this.boardData=new Float32Array(this.surfaces?0:20*this.layers),this.makeTextures(),this.vertices=e.createVertexArray(),this.surfaces){this.program=this.link("views",D,V);let s=A(this.width,this.height).levelAt;e.uniform1iv(e.getUniformLocation(this.program.program,"level_at"),s)}else{this.program=this.link("boards",B,I),this.instances=e.createBuffer(),e.bindVertexArray(this.vertices),e.bindBuffer(e.ARRAY_BUFFER,this.instances),e.bufferData(e.ARRAY_BUFFER,this.boardData.byteLength,e.DYNAMIC_DRAW);for(let s=0;s<20/4;++s)e.enableVertexAttribArray(s),e.vertexAttribPointer(s,4,e.FLOAT,!1,80,16*s),e.vertexAttribDivisor(s,1);e.bindVertexArray(null)}}update(e,o,i){++this.frame,this.sort(e,o,i),this.upload();let t=0;for(let r of this.slots)(r.coming||r.next)&&++t;for(let r=0;r<this.layers&&t<2;++r){let a=this.order[r],s=this.slots[a];s.layer>=0||s.coming||s.failed||s.next||(s.coming=!0,++t,this.load(a))}}get settled(){let e=this.surfaces?Math.min(_,this.slots.length):this.layers;for(let o=0;o<e;++o){let i=this.slots[this.order[o]];if(i.layer<0&&!i.failed)return!1}return!0}get allFailed(){return this.slots.every(e=>e.failed)}prepare(){}draw(e,o){let{gl:i,stats:t}=this;if(t.drawCalls=t.triangles=t.drawn=0,t.there===0)return;U(e,this.clip);let r=e.worldFromEye;i.useProgram(this.program.program);let{at:a}=this.program;i.uniformMatrix4fv(a.clip_from_local,!1,this.clip),i.uniform4f(a.forward_near,-r[8],-r[9],-r[10],o),this.bind(),i.bindVertexArray(this.vertices),this.surfaces?this.drawSurfaces(r):this.drawBoards(r),i.bindVertexArray(null),t.drawCalls=1}dispose(){let{gl:e}=this;this.disposed=!0;for(let o of this.slots)o.next?.colors.close();for(let o of Object.values(this.textures))e.deleteTexture(o);e.deleteProgram(this.program.program),e.deleteVertexArray(this.vertices),e.deleteBuffer(this.instances)}link(e,o,i){let{gl:t}=this,r=F(t,e,o,i);return t.useProgram(r),R.forEach((a,s)=>t.uniform1i(t.getUniformLocation(r,`${a}_texture`),s)),{program:r,at:Object.fromEntries(X.map(a=>[a,t.getUniformLocation(r,a)]))}}makeTextures(){let{gl:e,width:o,height:i}=this,t=(r,a,s=o,l=i,d=e.NEAREST)=>{let h=e.createTexture();e.bindTexture(e.TEXTURE_2D_ARRAY,h),e.texStorage3D(e.TEXTURE_2D_ARRAY,1,a,s,l,this.layers),e.texParameteri(e.TEXTURE_2D_ARRAY,e.TEXTURE_MIN_FILTER,d),e.texParameteri(e.TEXTURE_2D_ARRAY,e.TEXTURE_MAG_FILTER,d),this.textures[r]=h};if(t("color",e.RGBA8,o,i,e.LINEAR),t("code",e.R16UI),this.surfaces){let r=A(o,i);t("slope",e.RG32UI),t("links",e.R8UI),t("cell",e.RG32F,r.columns,r.rows)}e.bindTexture(e.TEXTURE_2D_ARRAY,null)}bind(){let{gl:e,textures:o}=this;for(let i=0;i<R.length;++i)e.activeTexture(e.TEXTURE0+i),e.bindTexture(e.TEXTURE_2D_ARRAY,o[R[i]]??null);e.activeTexture(e.TEXTURE0)}sort(e,o,i){let{entry:t,order:r,slots:a}=this,s=t.center;for(let l=0;l<r.length;++l){let d=t.list[l],h=d.worldFromEye,u=d.direction,f=this.surfaces?-(u[0]*(e-s[0])+u[1]*(o-s[1])+u[2]*(i-s[2])):Math.hypot(h[12]-e,h[13]-o,h[14]-i);a[l].key=f;let n=l;for(;n>0&&a[r[n-1]].key>f;--n)r[n]=r[n-1];r[n]=l}for(let l=0;l<this.layers;++l)a[r[l]].lastUsed=this.frame}async load(e){let o=this.slots[e],i=this.entry.list[e],t=null;try{let r=this.host.fetch(i.depths).then(l=>this.decoder.view(l,i.depths,{width:i.width,height:i.height,du:i.du,dv:i.dv,least:i.depths.least,step:i.depths.step,sigma:i.backPerspective?-1:1,links:this.surfaces?this.entry.links:null})),a=this.host.fetch(i.colors).then(async l=>{t=await P(await this.decoder.check(l,i.colors),i.colors,i.width,i.height)}),[s]=await Promise.all([r,a]);if(this.disposed)throw new x("walk","was disposed of");o.next={surface:s,colors:t},this.host.arrived()}catch(r){if(t?.close(),this.disposed)return;o.failed=!0,this.host.failed(S(r,`picture ${e}`))}finally{o.coming=!1}}freeLayer(){let e=new Set(this.slots.map(t=>t.layer));for(let t=0;t<this.layers;++t)if(!e.has(t))return t;let o=this.slots.filter(t=>t.layer>=0).reduce((t,r)=>r.lastUsed<t.lastUsed?r:t),{layer:i}=o;return o.layer=-1,--this.stats.there,i}upload(){let{gl:e,textures:o}=this,i=0;for(;i<this.slots.length&&!this.slots[i].next;)++i;if(i===this.slots.length)return;let t=this.slots[i],r=this.entry.list[i],{surface:a,colors:s}=t.next;t.next=null;let l=this.freeLayer(),{width:d,height:h}=r,u=(f,n,p,y,v=d,m=h)=>{e.bindTexture(e.TEXTURE_2D_ARRAY,o[f]??null),e.texSubImage3D(e.TEXTURE_2D_ARRAY,0,0,0,l,v,m,1,n,p,y)};e.pixelStorei(e.UNPACK_FLIP_Y_WEBGL,!1),e.pixelStorei(e.UNPACK_PREMULTIPLY_ALPHA_WEBGL,!1),e.pixelStorei(e.UNPACK_COLORSPACE_CONVERSION_WEBGL,e.NONE),e.bindTexture(e.TEXTURE_2D_ARRAY,o.color??null),e.texSubImage3D(e.TEXTURE_2D_ARRAY,0,0,0,l,d,h,1,e.RGBA,e.UNSIGNED_BYTE,s),e.pixelStorei(e.UNPACK_COLORSPACE_CONVERSION_WEBGL,e.BROWSER_DEFAULT_WEBGL),s.close(),e.pixelStorei(e.UNPACK_ALIGNMENT,1),u("code",e.RED_INTEGER,e.UNSIGNED_SHORT,a.codes),this.surfaces&&(u("slope",e.RG_INTEGER,e.UNSIGNED_INT,a.slopes),u("links",e.RED_INTEGER,e.UNSIGNED_BYTE,a.links),this.storeCells(l,d,h,a.cells)),e.pixelStorei(e.UNPACK_ALIGNMENT,4),e.bindTexture(e.TEXTURE_2D_ARRAY,null),t.layer=l,++this.stats.there,this.host.loaded(i)}storeCells(e,o,i,t){let{gl:r}=this,a=A(o,i),s=A(this.width,this.height);r.bindTexture(r.TEXTURE_2D_ARRAY,this.textures.cell??null),r.pixelStorei(r.UNPACK_ROW_LENGTH,a.columns);for(let l=0;l<4;++l){let d=(a.levelAt[l+1]??a.columns)-a.levelAt[l];r.pixelStorei(r.UNPACK_SKIP_PIXELS,a.levelAt[l]),r.texSubImage3D(r.TEXTURE_2D_ARRAY,0,s.levelAt[l],0,e,d,a.rows,1,r.RG,r.FLOAT,t)}r.pixelStorei(r.UNPACK_SKIP_PIXELS,0),r.pixelStorei(r.UNPACK_ROW_LENGTH,0)}drawSurfaces(e){let{gl:o,entry:i,slots:t,stats:r}=this,{at:a}=this.program,s=0,l=0,d=0,h=i.center,u=Math.hypot(e[12]-h[0],e[13]-h[1],e[14]-h[2])||1,f=0;for(let v=0;v<this.order.length&&s<_;++v){let m=this.order[v];if(t[m].layer<0)continue;let b=Math.acos(Math.max(-1,Math.min(1,-t[m].key/u)));s===0&&(f=b);let w=s===0?1:i.handover>0?Math.max(0,1-(b-f)/i.handover):0;w>0&&++l,this.weights[s]=w,this.says[2*s]=i.list[m].complete?1:0,this.says[2*s+1]=i.list[m].seesThrough?1:0,this.shown[s++]=m,d+=w}for(let v=0;v<s;++v)this.weights[v]/=d,this.setView(v,e);r.drawn=s;let{low:n,high:p}=i,y=i.slack;o.uniform3f(a.box_min,n[0]-y-e[12],n[1]-y-e[13],n[2]-y-e[14]),o.uniform3f(a.box_max,p[0]+y-e[12],p[1]+y-e[13],p[2]+y-e[14]),o.uniform4fv(a.view_data,this.viewData),o.uniform1fv(a.view_weights,this.weights),o.uniform2fv(a.view_says,this.says),o.uniform2i(a.view_counts,s,l),o.enable(o.CULL_FACE),o.cullFace(o.FRONT),o.drawArrays(o.TRIANGLE_STRIP,0,14),o.cullFace(o.BACK),o.disable(o.CULL_FACE),r.triangles=12}setView(e,o){let i=this.shown[e],t=this.entry.list[i],r=t.worldFromEye,a=this.viewData,{left:s,right:l,bottom:d,top:h}=t,u=t.width,f=t.height,n=4*g*e,p=0,y=0,v=0;for(let m=0;m<3;++m){let b=r[m],w=r[4+m],k=-r[8+m],T=r[12+m]-o[12+m],L=(b-s*k)*u/(l-s),z=(h*k-w)*f/(h-d);a[n+m]=L,a[n+4+m]=z,a[n+8+m]=k,a[n+12+m]=T,a[n+16+m]=k+s*b+h*w,a[n+20+m]=b*(l-s)/u,a[n+24+m]=-w*(h-d)/f,p-=L*T,y-=z*T,v-=k*T}a[n+3]=p,a[n+7]=y,a[n+11]=v,a[n+15]=t.backPerspective?-1:1,a[n+19]=this.slots[i].layer,a[n+23]=u,a[n+27]=f,a[n+28]=t.zNear,a[n+29]=t.zFar,a[n+30]=t.depths.least,a[n+31]=t.depths.step}drawBoards(e){let{gl:o,entry:i,slots:t,stats:r,boardData:a}=this,s=0;for(let l=0;l<t.length;++l){if(t[l].layer<0)continue;let d=i.list[l],h=d.worldFromEye,u=d.planeZ,f=20*s++;for(let n=0;n<3;++n){let p=h[n],y=h[4+n],v=-h[8+n];a[f+n]=h[12+n]-e[12+n],a[f+4+n]=u*(v+d.left*p+d.top*y),a[f+8+n]=u*(d.right-d.left)*p,a[f+12+n]=-u*(d.top-d.bottom)*y}a[f+3]=t[l].layer,a[f+7]=u,a[f+11]=d.width,a[f+15]=d.height,a[f+16]=d.depths.least,a[f+17]=d.depths.step,a[f+18]=1/this.width,a[f+19]=1/this.height}o.bindBuffer(o.ARRAY_BUFFER,this.instances),o.bufferSubData(o.ARRAY_BUFFER,0,a,0,20*s),o.disable(o.CULL_FACE),o.drawArraysInstanced(o.TRIANGLE_STRIP,0,4,s),r.drawn=s,r.triangles=2*s}};export{C as PictureSet};
